// The panel beside K3D's picture. RUN: what rodsim/export/page.py knows of the run.
// Frames are K3D's time: frame 7 is time 7.

const world = K3DInstance.getWorld();
const steps = 20; // frames a second, in play
let frame = 0;
let playing = null;

function add(parent, tag, attributes = {}, text = "") {
  const node = document.createElement(tag);
  Object.entries(attributes).forEach(([name, value]) => node.setAttribute(name, value));
  node.textContent = text;
  parent.appendChild(node);
  return node;
}

// The panel, from top to bottom

document.title = RUN.title;
add(document.head, "style", {}, RUN.css);
const panel = add(document.body, "div", { id: "panel" });
add(panel, "h1", {}, RUN.title);

const playRow = add(panel, "div", { class: "row" });
const play = add(playRow, "button", { id: "play" }, "Play");
const last = RUN.times.length - 1;
const slider = add(playRow, "input", { id: "frame", type: "range", min: 0, max: last, "aria-label": "frame" });
slider.value = 0;
const clock = add(panel, "div", { id: "clock", role: "status" });

const colourRow = add(panel, "div", { class: "row" });
add(colourRow, "label", { for: "colour" }, "Colour");
const colour = add(colourRow, "select", { id: "colour" });
["rod", ...Object.keys(RUN.scales)].forEach((name) => add(colour, "option", { value: name }, name));
colour.value = RUN.scales[RUN.colour] ? RUN.colour : "rod";
const switches = add(panel, "div", { class: "row" });
function addSwitch(id, text, checked, act) {
  const label = add(switches, "label");
  const box = add(label, "input", { id, type: "checkbox" });
  box.checked = checked;
  label.append(` ${text}`);
  box.addEventListener("change", () => act(box.checked));
}
addSwitch("grid", `grid of ${RUN.grid}`, true, (on) => K3DInstance.setGridVisible(on));
if (RUN.stripes.length) {
  addSwitch("stripe", "stripe along D1", true, (on) => {
    RUN.stripes.forEach((id) => (world.ObjectsListJson[id].visible = on));
    show(frame);
  });
}
const key = add(panel, "div", { id: "key" });

let now = null;
if (RUN.energies) {
  const picture = add(panel, "div", { id: "energies", "aria-label": "energies over time" });
  picture.innerHTML = RUN.energies.svg.slice(RUN.energies.svg.indexOf("<svg"));
  now = picture.querySelector("#now");
  picture.addEventListener("click", (event) => {
    const svg = picture.querySelector("svg");
    const box = svg.getBoundingClientRect();
    const x = ((event.clientX - box.left) / box.width) * svg.viewBox.baseVal.width;
    const { from, to, span } = RUN.energies;
    const time = span[0] + ((x - from) / (to - from)) * (span[1] - span[0]);
    const far = RUN.times.map((t) => Math.abs(t - time));
    show(far.indexOf(Math.min(...far)));
  });
}
add(panel, "p", {}, `Tubes: radius ${RUN.radius}.`);
add(panel, "p", {}, "Drag to turn, wheel to zoom, right button to move. A click on the energies goes to that time.");

// Colours: a value at each point is one byte

const bytes = {};
Object.entries(RUN.scales).forEach(([name, scale]) => {
  bytes[name] = (scale.values || []).map((text) => Uint8Array.from(atob(text), (c) => c.charCodeAt(0)));
});

function values(name, number, points) {
  if (name === "rod") return new Float32Array(0);
  if (name === "time") return new Float32Array(points).fill(last ? (255 * frame) / last : 0);
  return Float32Array.from(bytes[name][number].subarray(frame * points, (frame + 1) * points));
}

function paint() {
  const name = colour.value;
  RUN.rods.forEach((rod, number) => {
    const json = world.ObjectsListJson[rod.object];
    const data = values(name, number, rod.points);
    json.attribute = { data, shape: [data.length] };
    json.color_range = name === "rod" ? [] : [0, 255];
    if (name !== "rod") {
      const map = Float32Array.from(RUN.scales[name].map);
      json.color_map = { data: map, shape: [map.length / 4, 4] };
    }
  });
}

function explain() {
  key.replaceChildren();
  if (colour.value === "rod") {
    const list = add(key, "ul");
    RUN.rods.forEach((rod) => add(list, "li", { style: `--hue: ${rod.hue}` }, rod.name));
    return;
  }
  const { map, ends } = RUN.scales[colour.value];
  const stops = [];
  for (let k = 0; k < map.length; k += 4) {
    const rgb = map.slice(k + 1, k + 4).map((part) => Math.round(255 * part));
    stops.push(`rgb(${rgb.join(",")}) ${100 * map[k]}%`);
  }
  add(key, "div", { class: "bar", style: `background: linear-gradient(to right, ${stops.join(", ")})` });
  const row = add(key, "div", { class: "ends" });
  ends.forEach((text) => add(row, "span", {}, text));
}

// A frame

function show(number) {
  frame = number;
  slider.value = number;
  const time = RUN.times[number];
  clock.textContent = `t = ${Number(time.toPrecision(4))} ${RUN.time_unit}  (frame ${number + 1} of ${last + 1})`;
  if (now) {
    const { from, to, span } = RUN.energies;
    const share = (time - span[0]) / (span[1] - span[0]);
    now.setAttribute("transform", `translate(${share * (to - from)} 0)`);
  }
  paint();
  return K3DInstance.setTime(number);
}

slider.addEventListener("input", () => show(Number(slider.value)));
colour.addEventListener("change", () => {
  explain();
  show(frame);
});
play.addEventListener("click", () => {
  play.textContent = playing ? "Play" : "Pause";
  if (playing) {
    clearInterval(playing);
    playing = null;
  } else {
    playing = setInterval(() => show((frame + 1) % (last + 1)), 1000 / steps);
  }
});

explain();
window.dispatchEvent(new Event("resize")); // the picture has become narrower
show(0).then(() => document.body.setAttribute("data-ready", "yes"));
