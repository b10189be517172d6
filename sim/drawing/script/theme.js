"use strict";
// Light and dark: as the system prefers, until the reader switches; what is drawn asks for its colours here.
const theme = (() => {
  const root = document.documentElement;
  const prefersDark = matchMedia("(prefers-color-scheme: dark)");
  const watchers = [];
  let chosen = stored();
  let button = null;
  let known = new Map();

  root.classList.add("scripted");
  apply();
  prefersDark.addEventListener("change", apply);
  document.addEventListener("DOMContentLoaded", addSwitch);

  function stored() {
    try { return localStorage.getItem("torquer-theme"); } catch { return null; }
  }

  function isDark() { return chosen ? chosen === "dark" : prefersDark.matches; }

  function apply() {
    root.dataset.theme = isDark() ? "dark" : "light";
    known = new Map();
    if (button) button.textContent = isDark() ? "☀ Light" : "☾ Dark";
    for (const watcher of watchers) watcher();
  }

  function addSwitch() {
    const header = document.querySelector("header");
    if (!header) return;
    button = document.createElement("button");
    button.type = "button";
    button.className = "theme";
    button.addEventListener("click", () => {
      chosen = isDark() ? "light" : "dark";
      try { localStorage.setItem("torquer-theme", chosen); } catch { /* a page of no origin keeps nothing */ }
      apply();
    });
    header.prepend(button);
    apply();
  }

  // The colour that a light page has, as this page has it.
  function colour(light) {
    if (!known.has(light)) {
      const probe = document.createElement("span");
      probe.style.color = `var(--plot-${light.slice(1)}, ${light})`;
      document.body.append(probe);
      known.set(light, getComputedStyle(probe).color);
      probe.remove();
    }
    return known.get(light);
  }

  return { colour, watch: (watcher) => watchers.push(watcher), isDark };
})();
