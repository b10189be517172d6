"use strict";
// The data of the page, the time that all drawings show, and the part of the flight that all charts show.
const flight = JSON.parse(document.getElementById("data").textContent);

function unpack(text) {
  const bytes = Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
  return new Float32Array(bytes.buffer);
}

function make(tag, attributes = {}, ...content) {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, value);
  element.append(...content);
  return element;
}

function shared(state) {
  const watchers = [];
  return {
    state,
    watch: (watcher) => watchers.push(watcher),
    set: (values, source) => {
      Object.assign(state, values);
      for (const watcher of watchers) watcher(state, source);
    },
  };
}

const clock = shared({ t_s: 0, playing: false, pace: 1 });
const view = shared({ from_s: 0, to_s: flight.time.end_s });

function showSpan(from_s, to_s) {
  const end_s = flight.time.end_s;
  const length_s = Math.min(Math.max(to_s - from_s, 2), end_s);
  const start_s = Math.min(Math.max(from_s, 0), end_s - length_s);
  view.set({ from_s: start_s, to_s: start_s + length_s });
}

function zoom(factor) {
  const { from_s, to_s } = view.state;
  const inside = clock.state.t_s >= from_s && clock.state.t_s <= to_s;
  const middle_s = inside ? clock.state.t_s : (from_s + to_s) / 2;
  showSpan(middle_s - (middle_s - from_s) / factor, middle_s + (to_s - middle_s) / factor);
}

function move(part) {
  const by_s = part * (view.state.to_s - view.state.from_s);
  showSpan(view.state.from_s + by_s, view.state.to_s + by_s);
}

function showAll() { showSpan(0, flight.time.end_s); }

function step(part) {
  const by_s = part * (view.state.to_s - view.state.from_s);
  clock.set({ t_s: Math.min(Math.max(clock.state.t_s + by_s, 0), flight.time.end_s) });
}

// The bar that stays in sight: play, time, zoom.
(() => {
  const place = document.getElementById("time-bar");
  if (!place) return;
  const PACES = [1, 10, 60, 300, 1000, 5000];
  const button = (text, label, act) => {
    const made = make("button", { type: "button", "aria-label": label, title: label }, text);
    made.addEventListener("click", act);
    return made;
  };
  const play = button("▶", "Play", () => clock.set({ playing: !clock.state.playing }));
  const pace = make("select", { "aria-label": "Pace" });
  for (const times of PACES) pace.append(make("option", { value: times }, `${times}×`));
  const best = PACES.findLast((times) => times <= flight.time.end_s / 40) ?? 1;
  pace.value = best;
  const slider = make("input", { type: "range", min: 0, max: 10000, value: 0, "aria-label": "Time" });
  const text = make("output", { class: "time" });
  slider.addEventListener("input", () => clock.set({ t_s: (slider.value / 10000) * flight.time.end_s }));
  const zooms = make("span", { class: "zooms" },
    button("−", "Zoom out", () => zoom(0.5)), button("+", "Zoom in", () => zoom(2)),
    button("◀", "Earlier", () => move(-0.25)), button("▶", "Later", () => move(0.25)),
    button("All", "The whole flight", showAll));
  place.append(play, pace, slider, text, zooms);

  clock.watch(({ t_s, playing }) => {
    slider.value = Math.round((t_s / flight.time.end_s) * 10000);
    const utc = new Date((flight.time.start_unix_s + t_s) * 1000).toISOString().slice(0, 19).replace("T", " ");
    text.textContent = `${t_s.toFixed(0)} s · ${inUnits(t_s)} · ${utc} UTC`;
    slider.setAttribute("aria-valuetext", `${t_s.toFixed(0)} seconds`);
    const label = playing ? "Pause" : "Play";
    play.textContent = playing ? "❚❚" : "▶";
    play.title = label;
    play.setAttribute("aria-label", label);
  });

  function inUnits(t_s) {
    const [unit] = flight.time.label.split(" ");
    return `${(t_s / flight.time.unit_s).toFixed(2)} ${unit}`;
  }

  let before_ms = null;
  function frame(now_ms) {
    const { t_s, playing } = clock.state;
    if (playing && before_ms !== null) {
      const next_s = t_s + (Number(pace.value) * (now_ms - before_ms)) / 1000;
      const over = next_s >= flight.time.end_s;
      clock.set({ t_s: over ? flight.time.end_s : next_s, playing: !over, pace: Number(pace.value) });
    }
    before_ms = clock.state.playing ? now_ms : null;
    if (clock.state.playing) requestAnimationFrame(frame);
  }
  let running = false;
  clock.watch(({ playing, t_s }) => {
    if (playing && !running) {
      if (t_s >= flight.time.end_s) clock.state.t_s = 0;
      requestAnimationFrame(frame);
    }
    running = playing;
  });
})();
