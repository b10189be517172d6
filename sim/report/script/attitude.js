"use strict";
// The body as it turns, seen from the orbital frame: coils, field, Sun and nadir at the time of the clock.
const motion = (() => {
  const raw = flight.motion;
  const lists = Object.fromEntries(
    ["t_s", "q", "b_t", "sun", "lit", "longitude", "latitude"].map((name) => [name, unpack(raw[name])]));
  const count = lists.t_s.length;

  // Row of the sample before a time, and how far it is on the way to the next, 0 to 1.
  function place(t_s) {
    let low = 0, high = count - 1;
    while (high - low > 1) {
      const middle = (low + high) >> 1;
      if (lists.t_s[middle] <= t_s) low = middle; else high = middle;
    }
    const span_s = lists.t_s[high] - lists.t_s[low];
    return [low, high, span_s > 0 ? Math.min(Math.max((t_s - lists.t_s[low]) / span_s, 0), 1) : 0];
  }

  const row = (list, at, width) => Array.from(list.subarray(at * width, at * width + width));
  const dot = (a, b) => a.reduce((sum, one, index) => sum + one * b[index], 0);

  function quaternion(t_s) {
    const [low, high, part] = place(t_s);
    const one = row(lists.q, low, 4);
    let other = row(lists.q, high, 4);
    if (dot(one, other) < 0) other = other.map((value) => -value);
    const mixed = one.map((value, index) => value + part * (other[index] - value));
    const norm = Math.hypot(...mixed) || 1;
    return mixed.map((value) => value / norm);
  }

  // Body axes in orbital axes are the rows of C, v_body = C v_orbit.
  function matrix([q0, q1, q2, q3]) {
    return [
      [q0 * q0 + q1 * q1 - q2 * q2 - q3 * q3, 2 * (q1 * q2 + q0 * q3), 2 * (q1 * q3 - q0 * q2)],
      [2 * (q1 * q2 - q0 * q3), q0 * q0 - q1 * q1 + q2 * q2 - q3 * q3, 2 * (q2 * q3 + q0 * q1)],
      [2 * (q1 * q3 + q0 * q2), 2 * (q2 * q3 - q0 * q1), q0 * q0 - q1 * q1 - q2 * q2 + q3 * q3],
    ];
  }

  function turned(C, v_body) {
    return [0, 1, 2].map((axis) => C[0][axis] * v_body[0] + C[1][axis] * v_body[1] + C[2][axis] * v_body[2]);
  }

  // A vector in orbital axes, between two samples of it in body axes, each turned by its own attitude.
  function inOrbit(list, t_s) {
    const [low, high, part] = place(t_s);
    const [one, other] = [low, high].map((at) => turned(matrix(row(lists.q, at, 4)), row(list, at, 3)));
    return one.map((value, index) => value + part * (other[index] - value));
  }

  return { ...lists, count, sides: raw.sides, land: raw.land, place, quaternion, matrix, turned, inOrbit };
})();

const pulsesNow = (() => {
  const lanes = flight.charts.raster ? flight.charts.raster.panels[0].lanes : [];
  // The level at which each coil is driven at a time.
  return (t_s) => lanes.map((lane) => {
    let low = 0, high = lane.spans_s.length;
    while (low < high) {
      const middle = (low + high) >> 1;
      if (lane.spans_s[middle][0] <= t_s) low = middle + 1; else high = middle;
    }
    return low && t_s < lane.spans_s[low - 1][1] ? lane.levels[low - 1] : 0;
  });
})();

(() => {
  const canvas = document.getElementById("attitude-view");
  if (!canvas) return;
  const words = document.getElementById("attitude-words");
  const INK = "#1b2733", MUTED = "#5b6b7b", PAPER = "#ffffff", AXES = ["#0072b2", "#d55e00", "#009e73"];
  const FIELD = "#7b3fa0", SUN = "#e69f00", NADIR = "#5b6b7b";
  const { project } = turnedView(canvas, draw);

  function draw() {
    const size = Math.min(canvas.clientWidth, 520), ratio = devicePixelRatio || 1;
    if (!size) return;
    if (canvas.width !== Math.round(size * ratio)) {
      canvas.width = canvas.height = Math.round(size * ratio);
    }
    const ctx = canvas.getContext("2d");
    ctx.setTransform(ratio, 0, 0, ratio, 0, 0);
    ctx.clearRect(0, 0, size, size);
    const scale = 0.225 * size, middle = size / 2;
    const at = (v) => { const [x, y] = project(v); return [middle + scale * x, middle - scale * y]; };
    const t_s = clock.state.t_s;
    const C = motion.matrix(motion.quaternion(t_s));
    const body = (v) => motion.turned(C, v);
    const placed = labelPlaces();

    const line = (from, to, colour, width, dash = []) => {
      ctx.strokeStyle = theme.colour(colour);
      ctx.lineWidth = width;
      ctx.setLineDash(dash);
      ctx.beginPath();
      ctx.moveTo(...at(from));
      ctx.lineTo(...at(to));
      ctx.stroke();
      ctx.setLineDash([]);
    };
    const arrow = (v, colour, label, width = 2, from = [0, 0, 0], dash = []) => {
      line(from, v, colour, width, dash);
      const [x, y] = at(v), [x0, y0] = at(from), turn = Math.atan2(y - y0, x - x0);
      ctx.fillStyle = theme.colour(colour);
      arrowHead(ctx, x, y, turn);
      ctx.lineWidth = 3;
      ctx.strokeStyle = theme.colour(PAPER);
      const [lx, ly] = [x + 13 * Math.cos(turn), y + 13 * Math.sin(turn)];
      const half = ctx.measureText(label).width / 2;
      const tx = Math.min(Math.max(lx + half * Math.cos(turn), half + 2), size - half - 2);
      const ty = placed(tx, ly, half);
      ctx.strokeText(label, tx, ty);
      ctx.fillText(label, tx, ty);
    };

    for (const [axis, label] of [[[1.75, 0, 0], "radius"], [[0, 1.75, 0], "along-track"], [[0, 0, 1.75], "normal"]]) {
      arrow(axis, MUTED, label, 1, [0, 0, 0], [2, 4]);
    }
    const field_t = motion.inOrbit(motion.b_t, t_s), sun = motion.inOrbit(motion.sun, t_s);
    const lit = motion.lit[motion.place(t_s)[0]] > 0.5;
    const unit = (v, length) => v.map((one) => (length * one) / (Math.hypot(...v) || 1));
    const vectors = [
      [unit(field_t, 1.85), FIELD, "B", []],
      [unit(sun, 1.85), SUN, lit ? "Sun" : "Sun (eclipse)", lit ? [] : [5, 4]],
      [[-1.85, 0, 0], NADIR, "nadir", []],
    ];
    const far = vectors.filter(([v]) => project(v)[2] < 0), near = vectors.filter(([v]) => project(v)[2] >= 0);
    for (const [v, colour, label, dash] of far) arrow(v, colour, label, 2.5, [0, 0, 0], dash);

    const half = motion.sides.map((side) => 0.72 * side), levels = pulsesNow(t_s);
    const faces = [];
    for (const axis of [0, 1, 2]) for (const sign of [-1, 1]) faces.push({ axis, sign, depth: project(body(unitAxis(axis, sign)))[2] });
    // A convex body: only the faces towards the viewer are seen.
    for (const { axis, sign, depth } of faces.filter((face) => face.depth > 0)) {
      const [one, other] = [(axis + 1) % 3, (axis + 2) % 3];
      const corner = (a, b) => { const v = [0, 0, 0]; v[axis] = sign * half[axis]; v[one] = a * half[one]; v[other] = b * half[other]; return body(v); };
      ctx.beginPath();
      [[-1, -1], [1, -1], [1, 1], [-1, 1]].forEach(([a, b], index) => ctx[index ? "lineTo" : "moveTo"](...at(corner(a, b))));
      ctx.closePath();
      ctx.globalAlpha = 0.93;
      ctx.fillStyle = shade(depth);
      ctx.fill();
      ctx.globalAlpha = 1;
      ctx.strokeStyle = theme.colour(INK);
      ctx.lineWidth = 1.2;
      ctx.stroke();
      // The coil that drives along this axis is wound about it.
      ctx.beginPath();
      for (let step = 0; step <= 40; step += 1) {
        const angle = (step / 20) * Math.PI;
        ctx[step ? "lineTo" : "moveTo"](...at(corner(0.62 * Math.cos(angle), 0.62 * Math.sin(angle))));
      }
      ctx.strokeStyle = theme.colour(AXES[axis]);
      ctx.lineWidth = levels[axis] ? 6 : 2;
      ctx.stroke();
    }
    for (const axis of [0, 1, 2]) {
      const from = unitAxis(axis, half[axis]);
      if (project(body(unitAxis(axis, 1)))[2] > -0.25) arrow(body(unitAxis(axis, half[axis] + 0.45)), AXES[axis], String(axis + 1), 2, body(from));
    }
    levels.forEach((level, axis) => {
      if (level) arrow(body(unitAxis(axis, Math.sign(level) * (half[axis] + 0.7))), AXES[axis], `coil ${axis}: ${level > 0 ? "+" : ""}${level}`, 5);
    });
    for (const [v, colour, label, dash] of near) arrow(v, colour, label, 2.5, [0, 0, 0], dash);
    tell(C, field_t, lit, levels);
  }

  function unitAxis(axis, length) { const v = [0, 0, 0]; v[axis] = length; return v; }

  function shade(depth) {
    const light = theme.isDark() ? 22 + 16 * depth : 84 + 12 * depth;
    return `hsl(210 18% ${light}%)`;
  }

  function tell(C, field_t, lit, levels) {
    const cosine = (C[0][0] + C[1][1] + C[2][2] - 1) / 2;
    const deg = (value) => ((Math.acos(Math.min(Math.max(value, -1), 1)) * 180) / Math.PI).toFixed(2);
    const driven = levels.flatMap((level, coil) => (level ? [`coil ${coil} at level ${level > 0 ? "+" : ""}${level}`] : []));
    words.textContent = [
      `${deg(cosine)}° from nominal`, `axis 1 ${deg(C[0][0])}° from the vertical`,
      `field ${(Math.hypot(...field_t) * 1e6).toFixed(1)} µT`, lit ? "sunlit" : "eclipse",
      driven.join(", ") || "coils off",
    ].join(" · ");
  }

  canvas.addEventListener("keydown", (event) => {
    if (event.key !== " ") return;
    clock.set({ playing: !clock.state.playing });
    event.preventDefault();
  });

  clock.watch(draw);
  theme.watch(draw);
  new ResizeObserver(draw).observe(canvas);
  draw();
})();
