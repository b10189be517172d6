"use strict";
// From where directions in orbital axes are seen: a canvas that is turned by dragging and by the arrow keys.
function turnedView(canvas, draw) {
  let azimuth = -0.9, elevation = 0.45, from = null;

  function turnBy(right, down) {
    azimuth -= right;
    elevation = Math.min(Math.max(elevation + down, -1.5), 1.5);
    draw();
  }

  canvas.addEventListener("pointerdown", (event) => {
    from = [event.clientX, event.clientY];
    canvas.setPointerCapture(event.pointerId);
  });
  canvas.addEventListener("pointermove", (event) => {
    if (!from) return;
    turnBy(0.01 * (event.clientX - from[0]), 0.01 * (event.clientY - from[1]));
    from = [event.clientX, event.clientY];
  });
  for (const over of ["pointerup", "pointercancel"]) canvas.addEventListener(over, () => { from = null; });
  canvas.addEventListener("keydown", (event) => {
    const turns = { ArrowLeft: [-0.1, 0], ArrowRight: [0.1, 0], ArrowUp: [0, -0.1], ArrowDown: [0, 0.1] };
    if (!(event.key in turns)) return;
    turnBy(...turns[event.key]);
    event.preventDefault();
  });

  // Right, up and towards the viewer, of a vector in orbital axes; radius is up.
  function project([radius, along, normal]) {
    const [ca, sa] = [Math.cos(azimuth), Math.sin(azimuth)];
    const [ce, se] = [Math.cos(elevation), Math.sin(elevation)];
    const right = -sa * along + ca * normal, ahead = ca * along + sa * normal;
    return [right, ce * radius - se * ahead, se * radius + ce * ahead];
  }

  return { project };
}

// The head of an arrow that ends there, turned so; what is written next stands about its point.
function arrowHead(ctx, x, y, turn) {
  ctx.beginPath();
  ctx.moveTo(x, y);
  for (const side of [-1, 1]) ctx.lineTo(x - 10 * Math.cos(turn + side * 0.4), y - 10 * Math.sin(turn + side * 0.4));
  ctx.fill();
  ctx.font = "600 13px system-ui, sans-serif";
  ctx.textAlign = "center";
  ctx.textBaseline = "middle";
}

// Heights of the labels of a picture, by their middles and half their widths: none stands on another.
function labelPlaces() {
  const taken = [];
  return (middle, height, half) => {
    const over = ([x, y, width]) => Math.abs(x - middle) < width + half && Math.abs(y - height) < 14;
    while (taken.some(over)) height += 14;
    taken.push([middle, height, half]);
    return height;
  };
}
