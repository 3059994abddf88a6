// Tables, CSV and figures for the scripts of the pages.
"use strict";
(() => {
  const quoted = (cell) => (/[",\n]/.test(cell) ? `"${cell.replaceAll('"', '""')}"` : cell);

  // Returns CSV. Each line is a list of texts.
  window.hausbenchCsv = (lines) => lines.map((line) => line.map(quoted).join(",")).join("\n") + "\n";

  // Gives a table its head.
  window.hausbenchHead = (table, titles) => {
    (table.tHead ?? table.createTHead()).insertRow().append(...titles.map((title) => Object.assign(document.createElement("th"), {scope: "col", textContent: title})));
  };

  function csv(points) {
    const names = Object.keys(points[0] ?? {}).filter((name) => name !== "title");
    return window.hausbenchCsv([names, ...points.map((one) => names.map((name) => String(one[name] ?? "")))]);
  }

  // The colours of the page are written out, because the file has no page around it.
  function svg(picture) {
    const alone = picture.cloneNode(true), style = getComputedStyle(document.documentElement);
    alone.setAttribute("xmlns", "http:" + "//www.w3.org/2000/svg");
    return alone.outerHTML.replaceAll(/var\((--\w+)\)/g, (whole, name) => style.getPropertyValue(name).trim() || whole);
  }

  function link(kind, name, content) {
    const made = Object.assign(document.createElement("a"), {href: "#", download: `${name}.${kind}`, textContent: `Download as ${kind.toUpperCase()}`, className: kind});
    made.addEventListener("click", () => { made.href = URL.createObjectURL(new Blob([content()])); });
    return made;
  }

  // Makes a figure of a drawing by Plot: one picture with a name, for screen readers, and links to download it as SVG and its points as CSV.
  window.hausbenchFigure = (made, label, points) => {
    const picture = made.matches("svg") ? made : made.querySelector(":scope > svg"), figure = document.createElement("figure"), links = document.createElement("p");
    picture.querySelectorAll("[aria-label], [aria-description]").forEach((part) => { part.removeAttribute("aria-label"); part.removeAttribute("aria-description"); });
    picture.setAttribute("role", "img");
    picture.setAttribute("aria-label", label);
    links.className = "downloads";
    links.append(link("svg", label, () => svg(picture)), " ", link("csv", label, () => csv(points)));
    figure.append(made, links);
    return figure;
  };
})();
