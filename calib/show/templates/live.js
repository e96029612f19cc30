/* Bokeh fills the places of a picture; a slider moves a dot along each line. */
async function live(data, roots, slider, steps, tracks) {
  const item = {docid: "sheet", roots: roots, root_ids: Object.keys(roots)};
  await Bokeh.embed.embed_items({sheet: data}, [item]);
  const input = document.getElementById(slider);
  if (!input) return;
  const dots = tracks.map(([id]) => Bokeh.documents.map(d => d.get_model_by_id(id)).find(Boolean));
  const move = () => {
    const i = Number(input.value), told = `${steps[i].toFixed(2)} g`;
    input.nextElementSibling.value = told;
    input.setAttribute("aria-valuetext", told);
    tracks.forEach(([, [x, y]], k) => {
      const text = isNaN(y[i]) ? "" : `${x[i].toPrecision(3)}; ${y[i].toPrecision(3)}`;
      dots[k].data = {x: [x[i]], y: [y[i]], text: [text]};
    });
  };
  input.addEventListener("input", move);
  move();
}
