/* Bokeh fills the places of a picture, one picture after another, and hides the still ones.
   Then pointer, taps and a slider tell what is there. */
let last = Promise.resolve();
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
  const made = Bokeh.documents.at(-1).roots().map(
    fig => ({fig, place: document.getElementById(roots[fig.id])}));
  for (const {fig, place} of made) {
    fig.toolbar.tools.filter(tool => tool.tooltips).forEach(tells);
    if (place.clientWidth < 400) for (const legend of fig.above.filter(one => one.items)) {
      fig.height += 20 * Math.floor(legend.items.length * (1 - 1 / legend.ncols));
      legend.ncols = 1;
    }
    fig.on_event("tap", tap => measure(fig, tap.x, made));
  }
  slider(made);
}
const digits = x => Number.isFinite(x) ? String(Number(x.toPrecision(4))) : "-";

/* Known values of lines under the pointer, with bounds; of a map, and the torques that they mean. */
function tells(tool) {
  const of_line = ([name, ...columns], source, i) => {
    const [x, low, high] = columns.map(key => source.get_column(key)[i]);
    const bounds = Number.isFinite(low) ? ` (${digits(low)} to ${digits(high)})` : "";
    return Number.isFinite(x) ? `${name}: ${digits(x)}${bounds}` : [];
  };
  const of_map = ([, right, up, front, rear, odds], ratio, x, y) => {
    const share = odds * ratio / (1 + odds * ratio), torques = [front * share, rear * (1 - share)];
    const texts = [`${right}: ${digits(x)}`, `${up}: ${digits(y)}`, `value: ${digits(ratio)}`];
    const [f, r] = torques.map(torque => digits(torque * y));
    return odds && ratio ? [...texts, `brake torque front ${f}, rear ${r} N m`] : texts;
  };
  tool.tooltips = (source, {index, image_index, x, y}) => {
    const texts = image_index
      ? of_map(tool.tags, source.get_column("image")[0][image_index.flat_index], x, y)
      : tool.tags.flatMap(row => of_line(row, source, index));
    return Object.assign(document.createElement("div"), {innerText: texts.join("\n")});
  };
}

/* A tap sets one of two cursors, in turn; below each panel of the axis is what is at both. */
function measure(fig, x, made) {
  const cursors = fig.center.filter(one => one.tags[0] == "cursor");
  if (cursors.length == 0) return;
  const [before, last] = cursors.map(one => one.location);
  const [a, b] = before == null ? [x, null] : [last ?? before, x];
  cursors.forEach((one, i) => one.setv({location: [a, b][i], visible: [a, b][i] != null}));
  if (b == null) return;
  const span = (name, first, last) =>
    `${name}: ${digits(first)} to ${digits(last)}, difference ${digits(last - first)}`;
  for (const one of made.filter(one => one.fig.x_range == fig.x_range)) {
    const rows = one.fig.renderers.filter(line => line.name).map(line => {
      const [xs, ys] = ["x", line.glyph.y.field].map(key => line.data_source.get_column(key));
      return span(line.name, ...[a, b].map(at => ys[xs.findIndex(x => x >= at)]));
    });
    one.out ??= one.place.parentElement.appendChild(document.createElement("output"));
    one.out.innerText = [span(fig.below[0].axis_label, a, b), ...rows].join("\n");
  }
}

/* An axis more of maps: between two slices a value is linear. */
function slider(made) {
  const sources = made.flatMap(({fig}) => fig.renderers.map(one => one.data_source));
  const maps = sources.filter(one => one.tags.length);
  if (maps.length == 0) return;
  const [name, min, max] = maps[0].tags, count = maps[0].columns().length - 1;
  const [label, input, shown] = ["label", "input", "b"].map(tag => document.createElement(tag));
  Object.assign(input, {type: "range", min, max, step: 0.05, value: 0});
  input.oninput = () => {
    const at = (input.value - min) / (max - min) * (count - 1), i = Math.min(Math.floor(at), count - 2);
    for (const source of maps) {
      const [low, step] = source.tags.slice(3);
      const [image, a, b] = ["image", `slice${i}`, `slice${i + 1}`].map(key => source.get_column(key)[0]);
      image.forEach((x, k) => {
        if (Number.isFinite(x)) image[k] = low + step * (a[k] + (at - i) * (b[k] - a[k]));
      });
      source.change.emit();
    }
    shown.innerText = input.value;
  };
  label.append(name, input, shown);
  made.find(({fig}) => fig.renderers.some(one => one.data_source == maps[0])).place.before(label);
}
