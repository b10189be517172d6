"use strict";
// The charts against time: one time axis and one cursor for all, series that can be put out, values in words.
const charts = (() => {
  const times = Array.from(unpack(flight.time.t_s), (t_s) => t_s / flight.time.unit_s);
  const unit_s = flight.time.unit_s;
  const plots = [];
  const INK = "#1b2733", GRID = "#c9d2dc", ECLIPSE = "#dde4ee", SPINE = "#8a97a5", BACKOFF = "#f7e3d3";
  const WARNING = "#e69f00", LIMIT = "#b3261e";
  const REACH = 0.42;
  let sharing = false;

  for (const place of document.querySelectorAll("[data-chart]")) {
    const chart = flight.charts[place.dataset.chart];
    chart.panels.forEach((panel, number) =>
      addPanel(place, panel, number === chart.panels.length - 1));
    place.closest("figure").classList.add("drawn");
  }

  view.watch(({ from_s, to_s }) => {
    sharing = true;
    for (const { plot } of plots) plot.setScale("x", { min: from_s / unit_s, max: to_s / unit_s });
    sharing = false;
  });
  clock.watch(({ t_s }, source) => {
    for (const entry of plots) showTime(entry, t_s, source !== entry.plot);
  });
  theme.watch(() => plots.forEach(({ plot }) => plot.redraw(false, true)));
  new ResizeObserver(() => plots.forEach(fit)).observe(document.querySelector("main"));
  showAll();
  clock.set({ t_s: 0 });

  function addPanel(place, panel, isLast) {
    const legend = make("div", { class: "legend", role: "group", "aria-label": `Series of ${panel.title}` });
    const host = make("div", {
      class: "canvas", tabindex: 0, role: "application",
      "aria-label": `${panel.title}, a chart against time. Arrows move the cursor, + and − zoom, 0 shows all.`,
    });
    place.append(make("h3", {}, panel.title), legend, host);
    const laned = panel.lanes !== undefined;
    const series = laned ? [] : panel.series;
    const data = [times, ...series.map((one) => values(unpack(one.y), panel.decades !== null))];
    if (laned) data.push(times.map(() => null));
    const height = panel.height + (isLast ? 44 : 26);
    const plot = new uPlot({
      width: host.clientWidth, height, padding: [6, 12, isLast ? 0 : 4, 0],
      legend: { show: false },
      cursor: { y: false, drag: { x: true, y: false, dist: 4 }, bind: { dblclick: () => () => showAll() } },
      scales: {
        x: { time: false, range: (_, low, high) => [low ?? 0, high ?? flight.time.end_s / unit_s] },
        y: laned ? { range: [-0.5, panel.lanes.length - 0.5] } : ordinate(panel),
      },
      axes: [xAxis(isLast), laned ? laneAxis(panel) : yAxis(panel)],
      series: [{}, ...(laned ? [{ show: false }] : series.map(asSeries))],
      hooks: {
        drawClear: [(u) => bands(u, flight.time.eclipses, ECLIPSE)],
        draw: [(u) => (laned ? drawLanes(u, panel) : drawLevels(u, panel)), drawEvents],
        setScale: [(u, key) => {
          if (key === "x" && !sharing) showSpan(u.scales.x.min * unit_s, u.scales.x.max * unit_s);
        }],
        setCursor: [(u) => {
          if (u.cursor.left >= 0 && u.cursor.event) {
            clock.set({ t_s: clamp(u.posToVal(u.cursor.left, "x") * unit_s) }, u);
          }
        }],
      },
    }, data, host);
    host.addEventListener("keydown", onKey);
    const entry = { plot, host, height, panel, data, cells: [] };
    plots.push(entry);
    (laned ? panel.lanes : series).forEach((one, index) => legend.append(legendItem(entry, one, index, laned)));
    if (!laned) {
      for (const level of panel.levels) {
        legend.append(make("span", { class: "item level" }, swatch(level.colour, true), level.label));
      }
    }
  }

  function clamp(t_s) { return Math.min(Math.max(t_s, 0), flight.time.end_s); }

  // A logarithmic ordinate has no room for zero.
  function values(numbers, logarithmic) {
    return Array.from(numbers, (y) => (Number.isFinite(y) && !(logarithmic && y <= 0) ? y : null));
  }

  function asSeries(one) {
    return {
      label: one.label, width: one.width * 1.2, stroke: () => theme.colour(one.colour),
      points: { show: times.length <= 60, size: 4, fill: () => theme.colour(one.colour) }, spanGaps: false,
    };
  }

  function wholeShown(u) {
    return u.scales.x.min == null || u.scales.x.max - u.scales.x.min > 0.999 * (flight.time.end_s / unit_s);
  }

  function ordinate(panel) {
    const [low, high] = panel.reach;
    if (panel.decades !== null) {
      return {
        distr: 3,
        range: (u, least, most) => {
          if (least == null || wholeShown(u)) return [low, high];
          const top = most * 1.3;
          return [Math.max(least / 1.3, top / 10 ** panel.decades), top];
        },
      };
    }
    return {
      range: (u, least, most) => {
        if (least == null || wholeShown(u)) return [low, high];
        const margin = 0.06 * (most - least) || Math.abs(most) * 0.1 || 1;
        return [least - margin, most + margin];
      },
    };
  }

  function look() {
    return {
      stroke: () => theme.colour(INK), font: "12px system-ui, sans-serif",
      labelFont: "12px system-ui, sans-serif",
      grid: { stroke: () => theme.colour(GRID), width: 1 },
      ticks: { stroke: () => theme.colour(SPINE), width: 1, size: 5 },
    };
  }

  function xAxis(isLast) {
    return {
      ...look(), space: 60, size: isLast ? 26 : 22, labelSize: 18, labelGap: 0,
      ...(isLast ? { label: flight.time.label } : {}),
      values: (u, splits) => splits.map((value) => plain(value)),
    };
  }

  function yAxis(panel) {
    const style = look();
    if (panel.decades !== null) Object.assign(style.grid, { filter: rounded });
    return {
      ...style, size: 56, label: panel.label, labelSize: 18, space: 26,
      values: (u, splits) => splits.map((value) => (value == null ? "" : plain(value))),
      ...(panel.decades === null ? {} : { filter: rounded }),
    };
  }

  // Of a logarithmic axis 1, 2 and 5 of each decade, only 1 where there are many decades.
  function rounded(u, splits) {
    const decades = Math.log10(u.scales.y.max / u.scales.y.min);
    return splits.map((value) => {
      const first = value / 10 ** Math.floor(Math.log10(value) + 1e-9), leading = Math.round(first);
      if (Math.abs(first - leading) > 1e-6) return null;
      return leading === 1 || (decades < 2 && (leading === 2 || leading === 5)) || decades < 0.5 ? value : null;
    });
  }

  function laneAxis(panel) {
    const rows = panel.lanes.map((_, index) => index);
    return {
      ...look(), size: 74, grid: { show: false }, ticks: { show: false },
      splits: () => rows,
      values: () => rows.map((row) => panel.lanes[laneOf(panel, row)].label),
    };
  }

  // Modes rise from SAFE; coils are read from the top.
  function laneOf(panel, row) { return panel.most === undefined ? row : panel.lanes.length - 1 - row; }

  function plain(value) {
    if (value === 0) return "0";
    const size = Math.abs(value);
    return size >= 1e5 || size < 1e-3 ? value.toExponential(0) : String(Number(value.toPrecision(6)));
  }

  function bands(u, spans_s, colour, low = 0, high = 1) {
    const { left, top, width, height } = u.bbox;
    u.ctx.save();
    u.ctx.fillStyle = theme.colour(colour);
    for (const [from_s, to_s] of spans_s) {
      const from = Math.max(u.valToPos(from_s / unit_s, "x", true), left);
      const to = Math.min(u.valToPos(to_s / unit_s, "x", true), left + width);
      if (to > from) u.ctx.fillRect(from, top + low * height, to - from, (high - low) * height);
    }
    u.ctx.restore();
  }

  function clipped(u, draw) {
    u.ctx.save();
    u.ctx.beginPath();
    u.ctx.rect(u.bbox.left, u.bbox.top, u.bbox.width, u.bbox.height);
    u.ctx.clip();
    draw(u.ctx);
    u.ctx.restore();
  }

  function drawLevels(u, panel) {
    clipped(u, (ctx) => {
      for (const level of panel.levels) {
        const y = u.valToPos(level.value, "y", true);
        ctx.strokeStyle = theme.colour(level.colour);
        ctx.lineWidth = 1.2 * devicePixelRatio;
        ctx.setLineDash([5 * devicePixelRatio, 4 * devicePixelRatio]);
        ctx.beginPath();
        ctx.moveTo(u.bbox.left, y);
        ctx.lineTo(u.bbox.left + u.bbox.width, y);
        ctx.stroke();
      }
    });
  }

  function drawLanes(u, panel) {
    const lanes = panel.lanes.length;
    clipped(u, (ctx) => {
      panel.lanes.forEach((lane, index) => {
        if (lane.off) return;
        const row = laneOf(panel, index);
        if (panel.backoff_s) {
          const locking = panel.shared ? panel.lanes.flatMap((one) => one.spans_s) : lane.spans_s;
          const near = (end_s) => end_s < view.state.to_s && end_s + panel.backoff_s > view.state.from_s;
          const after = locking.filter(([, end_s]) => near(end_s)).map(([, end_s]) => [end_s, end_s + panel.backoff_s]);
          if (view.state.to_s - view.state.from_s < 60 * panel.backoff_s) {
            bands(u, after, BACKOFF, (lanes - 1 - row + 0.04) / lanes, (lanes - 1 - row + 0.96) / lanes);
          }
        }
        ctx.fillStyle = theme.colour(lane.colour);
        lane.spans_s.forEach(([from_s, to_s], place) => {
          if (to_s < view.state.from_s || from_s > view.state.to_s) return;
          const height = panel.most === undefined ? REACH : (REACH * lane.levels[place]) / panel.most;
          const low = panel.most === undefined ? -REACH : 0;
          const x = u.valToPos(from_s / unit_s, "x", true);
          const width = Math.max(u.valToPos(to_s / unit_s, "x", true) - x, 1.5 * devicePixelRatio);
          const top = u.valToPos(row + height, "y", true), bottom = u.valToPos(row + low, "y", true);
          ctx.fillRect(x, Math.min(top, bottom), width, Math.abs(bottom - top));
        });
      });
    });
  }

  // A mark at the top for each event that is more than information.
  function drawEvents(u) {
    const size = 5 * devicePixelRatio;
    clipped(u, (ctx) => {
      for (const { t_s, severity } of flight.events ?? []) {
        if (severity === "info") continue;
        const x = u.valToPos(t_s / unit_s, "x", true);
        ctx.fillStyle = theme.colour(severity === "warning" ? WARNING : LIMIT);
        ctx.beginPath();
        ctx.moveTo(x - size, u.bbox.top);
        ctx.lineTo(x + size, u.bbox.top);
        ctx.lineTo(x, u.bbox.top + 2 * size);
        ctx.fill();
      }
    });
  }

  function swatch(colour, dashed = false) {
    return make("i", { class: dashed ? "swatch dashed" : "swatch", style: `--swatch: var(--plot-${colour.slice(1)}, ${colour})` });
  }

  function legendItem(entry, one, index, laned) {
    const value = make("b", { class: "value" });
    const item = make("button", { type: "button", class: "item", "aria-pressed": "true" },
      swatch(one.colour), one.label, value);
    entry.cells.push(value);
    item.addEventListener("click", () => {
      const shown = item.getAttribute("aria-pressed") !== "true";
      item.setAttribute("aria-pressed", String(shown));
      one.off = !shown;
      if (laned) entry.plot.redraw(); else entry.plot.setSeries(index + 1, { show: shown });
    });
    return item;
  }

  function nearest(t_s) {
    const t = t_s / unit_s;
    let low = 0, high = times.length - 1;
    while (high - low > 1) {
      const middle = (low + high) >> 1;
      if (times[middle] <= t) low = middle; else high = middle;
    }
    return t - times[low] <= times[high] - t ? low : high;
  }

  function showTime({ plot, panel, data, cells }, t_s, moves) {
    if (moves) plot.setCursor({ left: plot.valToPos(t_s / unit_s, "x"), top: 10 }, false);
    const at = nearest(t_s);
    cells.forEach((cell, index) => {
      cell.textContent = panel.lanes ? inLane(panel, panel.lanes[index], t_s) : inWords(data[index + 1][at]);
    });
  }

  function inWords(value) { return value == null ? "–" : String(Number(value.toPrecision(4))); }

  // Of a mode whether it is on; of a coil its pulse, or how long ago the last one ended.
  function inLane(panel, lane, t_s) {
    const spans = lane.spans_s;
    const next = spans.findIndex(([from_s]) => from_s > t_s);
    const place = (next < 0 ? spans.length : next) - 1;
    if (place < 0) return "–";
    const [from_s, to_s] = spans[place];
    if (panel.most === undefined) return t_s < to_s ? "on" : "–";
    const level = lane.levels[place] > 0 ? `+${lane.levels[place]}` : String(lane.levels[place]);
    const length = `level ${level}, ${Number((to_s - from_s).toFixed(2))} s`;
    return t_s <= to_s ? length : `${length}, ${(t_s - to_s).toFixed(0)} s ago`;
  }

  function fit({ plot, host, height }) {
    if (host.clientWidth && host.clientWidth !== plot.width) plot.setSize({ width: host.clientWidth, height });
  }

  function onKey(event) {
    const acts = {
      ArrowLeft: () => step(event.shiftKey ? -0.1 : -0.01), ArrowRight: () => step(event.shiftKey ? 0.1 : 0.01),
      "+": () => zoom(2), "=": () => zoom(2), "-": () => zoom(0.5), 0: showAll, Home: showAll,
      " ": () => clock.set({ playing: !clock.state.playing }),
    };
    if (event.ctrlKey || event.metaKey || event.altKey || !(event.key in acts)) return;
    event.preventDefault();
    acts[event.key]();
  }

  return { plots };
})();
