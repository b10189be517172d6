"use strict";
// The body as it turns, seen from the orbital frame: coils, field, Sun and nadir at the time of the clock.
const motion = (() => {
  const raw = flight.motion;
  const lists = Object.fromEntries(
    ["t_s", "q", "b_t", "m_am2", "sun", "lit", "longitude", "latitude"].map((name) => [name, unpack(raw[name])]));
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

  // A vector in orbital axes, between two samples of it in body axes, each turned by its own attitude.
  function inOrbit(list, t_s) {
    const [low, high, part] = place(t_s);
    const [one, other] = [low, high].map((at) => turnedBack(axesOf(row(lists.q, at, 4)), row(list, at, 3)));
    return one.map((value, index) => value + part * (other[index] - value));
  }

  return { ...lists, count, sides: raw.sides, levels_am2: raw.levels_am2, land: raw.land, place, quaternion, inOrbit };
})();

const pulsesNow = (() => {
  const lanes = flight.charts.raster ? flight.charts.raster.panels[0].lanes : [];
  // The level at which each coil is driven at a time; a pulse stays in sight for a while after its end.
  return (t_s, stays_s = 0) => lanes.map((lane) => {
    let low = 0, high = lane.spans_s.length;
    while (low < high) {
      const middle = (low + high) >> 1;
      if (lane.spans_s[middle][0] <= t_s) low = middle + 1; else high = middle;
    }
    return low && t_s < lane.spans_s[low - 1][1] + stays_s ? lane.levels[low - 1] : 0;
  });
})();

(() => {
  const canvas = document.getElementById("attitude-view");
  if (!canvas) return;
  const words = document.getElementById("attitude-words");
  const SEEN_S = 0.25;  // played fast, a pulse would be over before it is seen
  clock.watch(coilView(canvas, scene));

  function scene() {
    const t_s = clock.state.t_s, C = axesOf(motion.quaternion(t_s)), at = motion.place(t_s)[0];
    const field = motion.inOrbit(motion.b_t, t_s), sun = motion.inOrbit(motion.sun, t_s), lit = motion.lit[at] > 0.5;
    const levels = pulsesNow(t_s, clock.state.playing ? SEEN_S * clock.state.pace : 0);
    const dipole = driven(levels, at), torque = dipole && torqueOf(turnedBack(C, dipole), field);
    const seen = {
      C, oriented: true, sides: motion.sides, field, sun, lit, levels: dipole ?? levels,
      dipole: dipole && turnedBack(C, dipole), torque,
      dipoleLabel: dipole && `m ${sizeIn(Math.hypot(...dipole), "A m²")}`,
      torqueLabel: torque && `T ${sizeIn(Math.hypot(...torque), "N m")}`,
    };
    tell(seen, levels);
    return seen;
  }

  // The dipole that is driven, A m^2, body axes; null where no coil is.
  function driven(levels, at) {
    const dipole = levels.length
      ? levels.map((level) => Math.sign(level) * (motion.levels_am2[Math.abs(level) - 1] ?? 0))
      : Array.from(motion.m_am2.subarray(3 * at, 3 * at + 3));
    return dipole.some((one) => one) ? dipole : null;
  }

  function tell({ C, field, lit, dipoleLabel, torqueLabel }, levels) {
    const cosine = (C[0][0] + C[1][1] + C[2][2] - 1) / 2;
    const deg = (value) => ((Math.acos(Math.min(Math.max(value, -1), 1)) * 180) / Math.PI).toFixed(2);
    const coils = levels.flatMap((level, coil) => (level ? [`coil ${coil} at level ${level > 0 ? "+" : ""}${level}`] : []));
    words.textContent = [
      `${deg(cosine)}° from nominal`, `axis 1 ${deg(C[0][0])}° from the vertical`,
      `field ${(Math.hypot(...field) * 1e6).toFixed(1)} µT`, lit ? "sunlit" : "eclipse",
      ...(dipoleLabel ? [...coils, `dipole ${dipoleLabel.slice(2)}`, `torque ${torqueLabel.slice(2)}`] : ["coils off"]),
    ].join(" · ");
  }

  canvas.addEventListener("keydown", (event) => {
    if (event.key !== " ") return;
    clock.set({ playing: !clock.state.playing });
    event.preventDefault();
  });
})();
