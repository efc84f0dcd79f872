"use strict";
// What the other parts of the script share: elements, numbers as texts, the state in the address.
const ct = {};
ct.constants = JSON.parse(document.getElementById("constants").textContent);
ct.byId = (id) => document.getElementById(id);

// Make an element. Children that are texts stay texts: names come from users.
ct.el = (tag, attributes = {}, ...children) => {
  const made = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (name.startsWith("on")) made.addEventListener(name.slice(2), value);
    else if (name === "style") made.style.cssText = value;
    else if (value !== false && value !== null) made.setAttribute(name, value === true ? "" : value);
  }
  made.append(...children.flat().filter((child) => child !== null && child !== ""));
  return made;
};

// A number in few characters, as the page's own texts have it.
ct.short = (value, digits = 3) => {
  if (value === null || value === undefined) return "–";
  if (value === 0 || !Number.isFinite(value)) return String(value);
  const size = Math.abs(value);
  if (size >= 1e-3 && size < 1e5) return String(Number(value.toPrecision(digits)));
  return value.toExponential(Math.max(0, digits - 2)).replace("e+", "e");
};
ct.count = (value) => String(value).replace(/\B(?=(\d{3})+$)/g, "\u202f");

ct.css = (color) => `rgb(${color[0]} ${color[1]} ${color[2]})`;

// The state that survives a reload stands in the address, where a file may keep it, too.
ct.state = () => Object.fromEntries(new URLSearchParams(location.hash.slice(1)));
ct.remember = (changes, step = false) => {
  const all = { ...ct.state(), ...changes };
  const kept = Object.entries(all).filter(([, value]) => value !== "" && value !== null);
  const hash = `#${new URLSearchParams(kept)}`;
  if (hash === location.hash || (hash === "#" && !location.hash)) return;
  if (step) location.hash = hash;
  else history.replaceState(null, "", hash === "#" ? location.pathname + location.search : hash);
};

ct.copy = (source, button) => {
  const done = () => {
    button.textContent = "copied";
    setTimeout(() => { button.textContent = "copy"; }, 1500);
  };
  const select = () => {
    const range = document.createRange();
    range.selectNodeContents(source);
    getSelection().removeAllRanges();
    getSelection().addRange(range);
  };
  if (!navigator.clipboard) { select(); return; }
  navigator.clipboard.writeText(source.textContent).then(done, select);
};

// A line to paste, with a button.
ct.line = (text, label) => {
  const code = ct.el("code", { "aria-label": label }, text);
  const button = ct.el("button", { type: "button", class: "copy", onclick: () => ct.copy(code, button) },
    "copy");
  return ct.el("div", { class: "paste" }, code, button);
};
