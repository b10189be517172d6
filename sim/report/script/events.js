"use strict";
// Each event of the table takes the clock to its time, and the charts to its surroundings.
(() => {
  const NEAR_S = 900;
  const rows = document.querySelectorAll("#events tbody tr");
  flight.events.forEach((event, number) => {
    const cell = rows[number].cells[0];
    const button = make("button", { type: "button", class: "when", title: "Show this time in all charts" }, cell.textContent);
    button.addEventListener("click", () => {
      clock.set({ t_s: Math.min(Math.max(event.t_s, 0), flight.time.end_s), playing: false });
      const { from_s, to_s } = view.state;
      if (event.t_s < from_s || event.t_s > to_s) showSpan(event.t_s - NEAR_S, event.t_s + NEAR_S);
      (document.getElementById("attitude-view") ?? cell).scrollIntoView({ block: "center" });
    });
    cell.replaceChildren(button);
  });
})();
