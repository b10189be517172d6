"use strict";
// The live view: snapshots come over a websocket several times a second; what is drawn is the last one.
const watch = (() => {
  const MOST_SAMPLES = 3600, MOST_ROWS = 200;
  const series = [[], [], [], [], [], []];  // time, turn, 3 sigma, rate, field off, Sun off
  const watchers = [];
  let last = null, connected = false;

  document.body.classList.add("waiting");
  connect();

  function connect() {
    const socket = new WebSocket(`ws://${location.host}/live`);
    socket.onopen = () => {
      connected = true;
      for (const list of series) list.length = 0;
      document.getElementById("happenings").replaceChildren();
    };
    socket.onmessage = (event) => take(JSON.parse(event.data));
    socket.onclose = () => {
      connected = false;
      tell();
      setTimeout(connect, 1000);
    };
  }

  function take(snapshot) {
    if (snapshot.samples.length && series[0].length && snapshot.samples[0][0] < series[0].at(-1)) {
      for (const list of series) list.length = 0;  // the time of the satellite went back
    }
    for (const sample of snapshot.samples) sample.forEach((value, column) => series[column].push(value));
    for (const list of series) list.splice(0, list.length - MOST_SAMPLES);
    last = snapshot;
    tell();
    for (const watcher of watchers) watcher(snapshot, series);
  }

  const text = (id, words) => { document.getElementById(id).textContent = words; };
  const number = (value, unit, digits = 2) => (value === null ? "–" : `${value.toFixed(digits)}${unit}`);

  function tell() {
    const badges = [];
    if (!connected) badges.push(["bad", "not connected to torquer watch"]);
    document.body.classList.toggle("waiting", !last || last.waits_for !== "");
    if (last) text("when", last.waits_for || `${last.time} UTC · tick ${last.state.tick}`);
    if (last && !last.waits_for) {
      const { state } = last;
      badges.push(["plain", state.mode ?? "no mode yet"]);
      badges.push(state.valid ? ["good", "attitude valid"] : ["bad", "attitude not valid"]);
      if (last.used) {
        badges.push(["plain", `magnetometer ${last.used.mag_blanked ? "blanked" : last.used.mag_used ? "used" : "not used"}`]);
        badges.push(["plain", `Sun sensor ${last.used.eclipse ? "in the shadow" : last.used.sun_used ? "used" : "not used"}`]);
      }
      if (state.refused) badges.push(["bad", `${state.refused} pulses refused`]);
      if (last.broken) badges.push(["bad", `${last.broken} broken frames`]);
      if (last.ended) badges.push(["plain", "the flight is over"]);
      text("numbers", [
        `${number(state.turn_deg, "°")} off nominal`, `3σ ${number(state.sigma3_deg, "°")}`,
        `rate ${number(state.rate_degps, "°/s", 3)}`, `field off prediction ${number(state.field_off_deg, "°")}`,
        `Sun off prediction ${number(state.sun_off_deg, "°")}`,
      ].join(" · "));
      text("load", `${(100 * state.bus_load).toFixed(1)} % of 125 kbit/s · ${last.frames_per_s.toFixed(0)} frames/s`);
      tellCoils();
      rows("frames", last.frames, false);
      rows("happenings", last.happenings.map(([, time, tick, weight, words]) => [time, tick ?? "", weight, words]), true);
    }
    document.getElementById("badges").replaceChildren(...badges.map(([kind, words]) => made("li", words, kind)));
  }

  function tellCoils() {
    const { state, fractions, lockout_ms } = last;
    const list = [0, 1, 2].map((coil) => {
      const level = state[`level_${coil}`];
      if (fractions) return `coil ${coil}: ${(100 * fractions[coil]).toFixed(0)} % of full`;
      const locked = lockout_ms[coil] ? `locked out for ${Math.ceil(lockout_ms[coil] / 1000)} s` : "free";
      return `coil ${coil}: ${level ? `level ${level > 0 ? "+" : ""}${level}, ${state.current_ma} mA` : "off"}, ${locked}`;
    });
    list.push(`${state.pulses} pulses, ${state.refused} refused`);
    document.getElementById("coils").replaceChildren(...list.map((words) => made("p", words, "meta")));
  }

  function made(tag, words, kind = "") {
    const element = document.createElement(tag);
    element.textContent = words;
    if (kind) element.className = kind;
    return element;
  }

  // Rows of a table; new happenings come on top of those that are there.
  function rows(id, values, prepended) {
    const body = document.getElementById(id);
    const made_rows = values.map((cells) => {
      const row = document.createElement("tr");
      row.append(...cells.map((cell) => made("td", cell)));
      return row;
    });
    if (!prepended) body.replaceChildren(...made_rows);
    else if (made_rows.length) body.prepend(...made_rows.reverse());
    while (body.children.length > MOST_ROWS) body.lastChild.remove();
  }

  return { watch: (watcher) => watchers.push(watcher), state: () => last };
})();

// The body as it was last told, in orbital axes; without an attitude in its own.
(() => {
  const UPRIGHT = [1, 0, 0, 0], SEEN_MS = 800;  // of a log that plays fast, a pulse is over before it is seen
  let pulses = 0, until_ms = 0;

  function scene() {
    const last = watch.state();
    if (!last) return null;
    const { q, sides, field_t, sun, in_units, driving } = last.body, C = axesOf(q ?? UPRIGHT);
    if (driving || last.state.pulses !== pulses) until_ms = performance.now() + SEEN_MS;
    pulses = last.state.pulses;
    const shown = performance.now() < until_ms, [dipole, torque] = shown ? [last.body.dipole, last.body.torque] : [null, null];
    const turned = (v) => v && turnedBack(C, v);
    const size = (v, unit) => (v && in_units ? ` ${sizeIn(Math.hypot(...v), unit)}` : "");
    return {
      C, oriented: q !== null, sides, field: turned(field_t), sun: turned(sun), lit: true, levels: dipole ?? [],
      dipole: turned(dipole), torque: turned(torque),
      dipoleLabel: `m${size(dipole, "A m²")}`, torqueLabel: `T${size(torque, "N m")}`,
    };
  }

  watch.watch(coilView(document.getElementById("attitude"), scene));
})();

(() => {
  const place = document.getElementById("charts");
  const CHARTS = [
    ["Attitude", "angle [deg]", [[1, "off nominal", "#0072b2"], [2, "3 sigma", "#8a97a5"]]],
    ["Rate", "rate [deg/s]", [[3, "rate", "#d55e00"]]],
    ["Measured against predicted", "angle [deg]", [[4, "field", "#7b3fa0"], [5, "Sun", "#e69f00"]]],
  ];
  const TIME = "time [UTC]";
  const HOURS = [[60, "{HH}:{mm}", null, null, null, null, null, null, 1], [1, "{HH}:{mm}:{ss}", null, null, null, null, null, null, 1]];
  const plots = CHARTS.map(([title, label, lines]) => {
    const head = document.createElement("h3"), host = document.createElement("div");
    head.textContent = title;
    host.setAttribute("role", "img");
    host.setAttribute("aria-label", `${title}: ${label} over ${TIME}`);
    place.append(head, host);
    const ink = () => theme.colour("#1b2733"), grid = () => theme.colour("#c9d2dc");
    const font = "12px system-ui, sans-serif";
    const axis = {
      stroke: ink, grid: { stroke: grid, width: 0.5 }, ticks: { stroke: grid }, font, labelFont: font, labelSize: 18,
    };
    const options = {
      width: Math.max(host.clientWidth, 200), height: 190, tzDate: (seconds) => uPlot.tzDate(new Date(seconds * 1e3), "UTC"),
      scales: { y: { range: (_, low, high) => [0, high > 0 ? 1.1 * high : 1] } },
      axes: [{ ...axis, values: HOURS, label: TIME }, { ...axis, size: 60, label }],
      series: [{ label: "UTC", value: "{HH}:{mm}:{ss}" }, ...lines.map(([, name, colour]) => ({
        label: name, stroke: () => theme.colour(colour), width: 1.5, points: { show: false },
        value: (_, value) => (value === null ? "–" : value.toFixed(3)),
      }))],
    };
    return { plot: new uPlot(options, [[], ...lines.map(() => [])], host), columns: [0, ...lines.map(([column]) => column)], host };
  });

  watch.watch((snapshot, series) => {
    if (!snapshot.samples.length) return;
    for (const { plot, columns } of plots) plot.setData(columns.map((column) => series[column].slice()));
  });
  theme.watch(() => plots.forEach(({ plot }) => plot.redraw(false, true)));
  new ResizeObserver(() => plots.forEach(({ plot, host }) => plot.setSize({ width: Math.max(host.clientWidth, 200), height: 190 }))).observe(place);
})();
