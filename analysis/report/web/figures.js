// Marks a figure that Plot drew as one picture with a name, for readers of screens.
"use strict";
window.hausbenchFigure = (made, label) => {
  const picture = made.matches("svg") ? made : made.querySelector(":scope > svg");
  picture.querySelectorAll("[aria-label], [aria-description]").forEach((part) => { part.removeAttribute("aria-label"); part.removeAttribute("aria-description"); });
  picture.setAttribute("role", "img");
  picture.setAttribute("aria-label", label);
  return made;
};
