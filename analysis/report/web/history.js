// The history of timings: the median CPU time of a case at each commit that was measured, with its interval.
"use strict";
(() => {
  const rows = window.hausbenchHistory, form = document.getElementById("tracked"), place = document.getElementById("times");
  const text = (x) => Number(x.toPrecision(4)).toString();
  for (const name of [...new Set(rows.map((row) => row.case))].sort()) form.elements.case.add(new Option(name, name));

  function show() {
    const own = rows.filter((row) => row.case === form.elements.case.value), table = document.createElement("table");
    window.hausbenchHead(table, ["measured", "machine", "commit", "ms", "interval, ms"]);
    const body = table.createTBody();
    for (const row of own) {
      const cells = body.insertRow(), interval = row.low === null ? "—" : `${text(1e3 * row.low)} to ${text(1e3 * row.high)}`;
      for (const value of [row.measured, row.machine, row.commit, text(1e3 * row.seconds), interval]) cells.insertCell().textContent = value;
    }
    place.replaceChildren(...plot(own), table);
  }

  function plot(own) {
    if (!window.Plot) return [];
    const points = own.map((row, k) => ({...row, at: `${k + 1}`, milliseconds: 1e3 * row.seconds, least: 1e3 * (row.low ?? row.seconds), most: 1e3 * (row.high ?? row.seconds)}));
    const made = Plot.plot({width: 900, height: 300, marginLeft: 60, marginBottom: 50, grid: true, color: {legend: true, type: "categorical"}, style: {background: "var(--paper)", color: "var(--ink)"},
      x: {type: "point", domain: points.map((one) => one.at), tickFormat: (at) => points[Number(at) - 1].commit.slice(0, 7), tickRotate: -30, label: null},
      y: {zero: true, label: "CPU time (ms)"},
      marks: [Plot.ruleX(points, {x: "at", y1: "least", y2: "most", stroke: "measured"}), Plot.dot(points, {x: "at", y: "milliseconds", stroke: "measured", tip: true, channels: {machine: "machine", commit: "commit"}})]});
    return [window.hausbenchFigure(made, "CPU time at each commit", own)];
  }

  form.addEventListener("input", show);
  form.addEventListener("submit", (event) => event.preventDefault());
  if (rows.length) show();
})();
