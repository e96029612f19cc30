/* Bokeh draws the panels of one picture after another in their places and hides the still ones.
   Then the pointer, taps and a slider show values. `panels` has figure and place of each panel. */
let last = Promise.resolve();  // ends when all pictures so far are drawn
function live(data, roots) {
  last = last.then(() => draw(data, roots));
}
async function draw(data, roots) {
  for (const id of Object.values(roots)) {
    const place = document.getElementById(id);
    place.hidden = false;
    place.nextElementSibling.className = "still";
  }
  await Bokeh.embed.embed_items({sheet: data}, [{docid: "sheet", roots, root_ids: Object.keys(roots)}]);
  const panels = Bokeh.documents.at(-1).roots().map(
    fig => ({fig, place: document.getElementById(roots[fig.id])}));
  for (const {fig, place} of panels) {
    fig.toolbar.tools.filter(tool => tool.tooltips).forEach(setTooltips);
    if (place.clientWidth < 400) for (const legend of fig.above.filter(item => item.items)) {
      const entries = legend.items.length, rows = Math.ceil(entries / legend.ncols);
      fig.height += 20 * (entries - rows);  // 20 px for a row, as in interactive.py
      legend.ncols = 1;
    }
    fig.on_event("tap", tap => setCursor(fig, tap.x, panels));
  }
  addSlider(panels);
}
const digits = x => Number.isFinite(x) ? String(Number(x.toPrecision(4))) : "-";

/* Values at the pointer: those of lines with their bounds, or that of a map with the torques.
   The tags of the tool come from `_hover` and `_image` of interactive.py. */
function setTooltips(tool) {
  const textOfLine = ([name, ...columns], source, i) => {
    const [y, low, high] = columns.map(key => source.get_column(key)[i]);
    const bounds = Number.isFinite(low) ? ` (${digits(low)} to ${digits(high)})` : "";
    return Number.isFinite(y) ? `${name}: ${digits(y)}${bounds}` : [];
  };
  const textsOfMap = ([xName, yName, front, rear, forceRatio], ratio, x, y) => {
    const texts = [`${xName}: ${digits(x)}`, `${yName}: ${digits(y)}`, `value: ${digits(ratio)}`];
    if (!forceRatio || !ratio) return texts;
    const share = forceRatio * ratio / (1 + forceRatio * ratio);  // of the front brakes in the force
    const [f, r] = [front * share, rear * (1 - share)].map(torque => digits(torque * y));
    return [...texts, `brake torque front ${f}, rear ${r} N m`];
  };
  tool.tooltips = (source, {index, image_index, x, y}) => {
    const texts = image_index
      ? textsOfMap(tool.tags, source.get_column("image")[0][image_index.flat_index], x, y)
      : tool.tags.flatMap(row => textOfLine(row, source, index));
    return Object.assign(document.createElement("div"), {innerText: texts.join("\n")});
  };
}

/* A tap sets the first cursor, the next tap the second; a further one moves the first to the place
   of the second, and the second to the tap. Below each panel with this x axis are the values at
   both cursors, and their difference. */
function setCursor(fig, x, panels) {
  const cursors = fig.center.filter(item => item.tags[0] == "cursor");
  if (cursors.length == 0) return;
  const [first, second] = cursors.map(cursor => cursor.location);
  const [start, end] = first == null ? [x, null] : [second ?? first, x];
  cursors.forEach((cursor, i) => {
    const location = [start, end][i];
    cursor.setv({location, visible: location != null});
  });
  if (end == null) return;
  const textOf = (name, a, b) => `${name}: ${digits(a)} to ${digits(b)}, difference ${digits(b - a)}`;
  for (const panel of panels.filter(panel => panel.fig.x_range == fig.x_range)) {
    const texts = panel.fig.renderers.filter(line => line.name).map(line => {
      const [xs, ys] = ["x", line.glyph.y.field].map(key => line.data_source.get_column(key));
      const [a, b] = [start, end].map(cursor => ys[xs.findIndex(x => x >= cursor)]);
      return textOf(line.name, a, b);
    });
    panel.out ??= panel.place.parentElement.appendChild(document.createElement("output"));
    panel.out.innerText = [textOf(fig.below[0].axis_label, start, end), ...texts].join("\n");
  }
}

/* A slider for the third axis of maps; between two slices a value is linear. */
function addSlider(panels) {
  const sources = panels.flatMap(({fig}) => fig.renderers.map(glyph => glyph.data_source));
  const maps = sources.filter(source => source.tags.length);
  if (maps.length == 0) return;
  const [name, min, max] = maps[0].tags, count = maps[0].columns().length - 1;  // of slices
  const [label, input, value] = ["label", "input", "b"].map(tag => document.createElement(tag));
  Object.assign(input, {type: "range", min, max, step: 0.05, value: 0});
  input.oninput = () => {
    const place = (input.value - min) / (max - min) * (count - 1);  // 0 is the first slice
    const i = Math.min(Math.floor(place), count - 2);
    for (const source of maps) {
      const [first, step] = source.tags.slice(3);  // value = first + step * byte
      const [image, a, b] = ["image", `slice${i}`, `slice${i + 1}`].map(key => source.get_column(key)[0]);
      image.forEach((x, k) => {
        if (Number.isFinite(x)) image[k] = first + step * (a[k] + (place - i) * (b[k] - a[k]));
      });
      source.change.emit();
    }
    value.innerText = input.value;
  };
  label.append(name, input, value);
  const isOfMap = glyph => glyph.data_source == maps[0];
  panels.find(({fig}) => fig.renderers.some(isOfMap)).place.before(label);
}
