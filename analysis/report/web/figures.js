// Makes a figure of what Plot drew: one picture with a name, for readers of screens, and links to download it as SVG and its points as CSV.
"use strict";
(() => {
  const quoted = (cell) => (/[",\n]/.test(cell) ? `"${cell.replaceAll('"', '""')}"` : cell);

  function csv(points) {
    const names = Object.keys(points[0] ?? {}).filter((name) => name !== "title");
    return [names, ...points.map((one) => names.map((name) => String(one[name] ?? "")))].map((line) => line.map(quoted).join(",")).join("\n") + "\n";
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
