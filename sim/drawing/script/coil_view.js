"use strict";
// The body with its coils in orbital axes: field, Sun and nadir, the dipole that is driven and its torque.
// scene() tells what there is: C, whose rows are the body axes in orbital axes; oriented, whether C is known;
// sides; field and sun in orbital axes, or null; lit; levels by coil; dipole and torque in orbital axes, or null;
// labels of these two.
function coilView(canvas, scene) {
  const INK = "#1b2733", MUTED = "#5b6b7b", PAPER = "#ffffff", AXES = ["#0072b2", "#d55e00", "#009e73"];
  const FIELD = "#7b3fa0", SUN = "#e69f00", DIPOLE = INK, TORQUE = "#b3261e", REACH = 1.85;
  const { project } = turnedView(canvas, draw);

  function draw() {
    const size = Math.min(canvas.clientWidth, 520), ratio = devicePixelRatio || 1;
    if (!size) return;
    if (canvas.width !== Math.round(size * ratio)) canvas.width = canvas.height = Math.round(size * ratio);
    const ctx = canvas.getContext("2d");
    ctx.setTransform(ratio, 0, 0, ratio, 0, 0);
    ctx.clearRect(0, 0, size, size);
    const seen = scene();
    if (!seen) return;
    const scale = 0.225 * size, middle = size / 2;
    const at = (v) => { const [x, y] = project(v); return [middle + scale * x, middle - scale * y]; };
    const body = (v) => [0, 1, 2].map((axis) => seen.C[0][axis] * v[0] + seen.C[1][axis] * v[1] + seen.C[2][axis] * v[2]);
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

    if (seen.oriented) {
      for (const [axis, label] of [[[1.75, 0, 0], "radius"], [[0, 1.75, 0], "along-track"], [[0, 0, 1.75], "normal"]]) {
        arrow(axis, MUTED, label, 1, [0, 0, 0], [2, 4]);
      }
    }
    const unit = (v, length) => v.map((one) => (length * one) / (Math.hypot(...v) || 1));
    const vectors = [];
    const add = (v, colour, label, width = 2.5, dash = []) => {
      if (v && Math.hypot(...v) > 0) vectors.push([unit(v, REACH), colour, label, width, dash]);
    };
    add(seen.field, FIELD, "B");
    add(seen.sun, SUN, seen.lit ? "Sun" : "Sun (eclipse)", 2.5, seen.lit ? [] : [5, 4]);
    add(seen.oriented ? [-1, 0, 0] : null, MUTED, "nadir");
    add(seen.dipole, DIPOLE, seen.dipoleLabel, 5);
    add(seen.torque, TORQUE, seen.torqueLabel, 5);
    const far = vectors.filter(([v]) => project(v)[2] < 0), near = vectors.filter(([v]) => project(v)[2] >= 0);
    for (const [v, colour, label, width, dash] of far) arrow(v, colour, label, width, [0, 0, 0], dash);
    drawBody(ctx, seen, at, body);
    const half = seen.sides.map((side) => 0.72 * side);
    for (const axis of [0, 1, 2]) {
      const from = unitAxis(axis, half[axis]);
      if (project(body(unitAxis(axis, 1)))[2] > -0.25) arrow(body(unitAxis(axis, half[axis] + 0.45)), AXES[axis], String(axis + 1), 2, body(from));
    }
    for (const [v, colour, label, width, dash] of near) arrow(v, colour, label, width, [0, 0, 0], dash);
  }

  // A convex body: only the faces towards the viewer are seen. The coil that drives along an axis is wound about it.
  function drawBody(ctx, seen, at, body) {
    const half = seen.sides.map((side) => 0.72 * side), faces = [];
    for (const axis of [0, 1, 2]) for (const sign of [-1, 1]) faces.push({ axis, sign, depth: project(body(unitAxis(axis, sign)))[2] });
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
      ctx.beginPath();
      for (let step = 0; step <= 40; step += 1) {
        const angle = (step / 20) * Math.PI;
        ctx[step ? "lineTo" : "moveTo"](...at(corner(0.62 * Math.cos(angle), 0.62 * Math.sin(angle))));
      }
      ctx.strokeStyle = theme.colour(AXES[axis]);
      ctx.lineWidth = seen.levels[axis] ? 6 : 2;
      ctx.stroke();
    }
  }

  function unitAxis(axis, length) { const v = [0, 0, 0]; v[axis] = length; return v; }

  function shade(depth) {
    const light = theme.isDark() ? 22 + 16 * depth : 84 + 12 * depth;
    return `hsl(210 18% ${light}%)`;
  }

  theme.watch(draw);
  new ResizeObserver(draw).observe(canvas);
  draw();
  return draw;
}

// Body axes in orbital axes are the rows of C, v_body = C v_orbit.
function axesOf([q0, q1, q2, q3]) {
  return [
    [q0 * q0 + q1 * q1 - q2 * q2 - q3 * q3, 2 * (q1 * q2 + q0 * q3), 2 * (q1 * q3 - q0 * q2)],
    [2 * (q1 * q2 - q0 * q3), q0 * q0 - q1 * q1 + q2 * q2 - q3 * q3, 2 * (q2 * q3 + q0 * q1)],
    [2 * (q1 * q3 + q0 * q2), 2 * (q2 * q3 - q0 * q1), q0 * q0 - q1 * q1 - q2 * q2 + q3 * q3],
  ];
}

// A vector in body axes, in orbital axes.
function turnedBack(C, v_body) {
  return [0, 1, 2].map((axis) => C[0][axis] * v_body[0] + C[1][axis] * v_body[1] + C[2][axis] * v_body[2]);
}

// The torque of a dipole in a field, dipole x field, in the axes of both.
function torqueOf([m1, m2, m3], [b1, b2, b3]) {
  return [m2 * b3 - m3 * b2, m3 * b1 - m1 * b3, m1 * b2 - m2 * b1];
}

// A size in the unit that suits it, three digits.
function sizeIn(size, unit) {
  const [factor, prefix] = [[1, ""], [1e-3, "m"], [1e-6, "µ"], [1e-9, "n"]].find(([least]) => size >= least) ?? [1e-9, "n"];
  return `${Number((size / factor).toPrecision(3))} ${prefix}${unit}`;
}
