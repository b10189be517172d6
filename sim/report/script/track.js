"use strict";
// The ground track on a map: the part that the charts show, the pulses, and where the satellite is.
(() => {
  const canvas = document.getElementById("track-view");
  if (!canvas) return;
  const words = document.getElementById("track-words");
  const INK = "#1b2733", MUTED = "#5b6b7b", GRID = "#c9d2dc", LAND = "#e8e6df", COAST = "#8a97a5", LIMIT = "#b3261e";
  const lanes = flight.charts.raster ? flight.charts.raster.panels[0].lanes : [];
  let ground = null;

  const x = (longitude) => ((longitude + 180) / 360) * canvas.width;
  const y = (latitude) => ((90 - latitude) / 180) * canvas.height;

  // What only zoom, colours and size change is kept as a picture.
  function drawGround() {
    const ratio = devicePixelRatio || 1, width = canvas.clientWidth;
    if (!width) return;
    canvas.width = Math.round(width * ratio);
    canvas.height = Math.round((width * ratio) / 2);
    ground = document.createElement("canvas");
    ground.width = canvas.width;
    ground.height = canvas.height;
    const ctx = ground.getContext("2d");
    ctx.lineWidth = ratio;
    ctx.strokeStyle = theme.colour(GRID);
    for (let longitude = -150; longitude <= 150; longitude += 30) stroke(ctx, [[longitude, -90], [longitude, 90]]);
    for (let latitude = -60; latitude <= 60; latitude += 30) stroke(ctx, [[-180, latitude], [180, latitude]]);
    ctx.fillStyle = theme.colour(LAND);
    ctx.strokeStyle = theme.colour(COAST);
    ctx.lineWidth = 0.7 * ratio;
    for (const outline of motion.land) {
      ctx.beginPath();
      for (let at = 0; at < outline.length; at += 2) ctx.lineTo(x(outline[at]), y(outline[at + 1]));
      ctx.closePath();
      ctx.fill();
      ctx.stroke();
    }
    const orbits = (view.state.to_s - view.state.from_s) / flight.motion.orbit_s, faint = Math.min(1, 5 / orbits);
    for (const dark of [false, true]) for (const inView of [false, true]) {
      ctx.globalAlpha = inView ? Math.max(0.3, faint) : 0.15;
      ctx.strokeStyle = theme.colour(dark ? MUTED : INK);
      ctx.lineWidth = (dark ? 2.6 : 1.2) * Math.max(0.5, faint) * ratio;
      drawPart(ctx, dark, inView);
    }
    ctx.globalAlpha = 1;
    for (const lane of lanes) {
      ctx.fillStyle = theme.colour(lane.colour);
      for (const [from_s, to_s] of lane.spans_s) {
        if (to_s < view.state.from_s || from_s > view.state.to_s) continue;
        const [longitude, latitude] = below(from_s);
        ctx.beginPath();
        ctx.arc(x(longitude), y(latitude), Math.max((width / 300) * Math.max(0.55, faint), 1.4) * ratio, 0, 7);
        ctx.fill();
      }
    }
    draw();
  }

  function stroke(ctx, points) {
    ctx.beginPath();
    for (const [longitude, latitude] of points) ctx.lineTo(x(longitude), y(latitude));
    ctx.stroke();
  }

  // All of the track that is dark, or not, in the part that the charts show, or outside of it.
  function drawPart(ctx, dark, inView) {
    const { from_s, to_s } = view.state;
    ctx.beginPath();
    for (let at = 1; at < motion.count; at += 1) {
      const shown = motion.t_s[at] >= from_s && motion.t_s[at - 1] <= to_s;
      const leaps = Math.abs(motion.longitude[at] - motion.longitude[at - 1]) > 180;
      if (leaps || shown !== inView || (motion.lit[at] < 0.5) !== dark) continue;
      ctx.moveTo(x(motion.longitude[at - 1]), y(motion.latitude[at - 1]));
      ctx.lineTo(x(motion.longitude[at]), y(motion.latitude[at]));
    }
    ctx.stroke();
  }

  function below(t_s) {
    const [low, high, part] = motion.place(t_s);
    let by = motion.longitude[high] - motion.longitude[low];
    by -= 360 * Math.round(by / 360);
    const longitude = motion.longitude[low] + part * by;
    return [longitude - 360 * Math.round(longitude / 360), motion.latitude[low] + part * (motion.latitude[high] - motion.latitude[low])];
  }

  function draw() {
    if (!ground) return;
    const ctx = canvas.getContext("2d"), ratio = devicePixelRatio || 1;
    ctx.clearRect(0, 0, canvas.width, canvas.height);
    ctx.drawImage(ground, 0, 0);
    const [longitude, latitude] = below(clock.state.t_s);
    ctx.strokeStyle = theme.colour(LIMIT);
    ctx.lineWidth = 2.5 * ratio;
    ctx.beginPath();
    ctx.arc(x(longitude), y(latitude), 7 * ratio, 0, 7);
    ctx.stroke();
    const side = (value, names) => `${Math.abs(value).toFixed(1)}° ${value < 0 ? names[1] : names[0]}`;
    words.textContent = `${side(latitude, "NS")}, ${side(longitude, "EW")}`;
  }

  canvas.addEventListener("click", (event) => {
    const box = canvas.getBoundingClientRect();
    const longitude = ((event.clientX - box.left) / box.width) * 360 - 180;
    const latitude = 90 - ((event.clientY - box.top) / box.height) * 180;
    let best = 0, least = Infinity;
    for (let at = 0; at < motion.count; at += 1) {
      if (motion.t_s[at] < view.state.from_s || motion.t_s[at] > view.state.to_s) continue;
      const away = (motion.longitude[at] - longitude) ** 2 + (motion.latitude[at] - latitude) ** 2;
      if (away < least) [best, least] = [at, away];
    }
    clock.set({ t_s: motion.t_s[best] });
  });

  canvas.closest("figure").classList.add("drawn");
  clock.watch(draw);
  view.watch(drawGround);
  theme.watch(drawGround);
  new ResizeObserver(() => { if (Math.round(canvas.clientWidth * (devicePixelRatio || 1)) !== canvas.width) drawGround(); }).observe(canvas);
  drawGround();
})();
