/* Bokeh fills the places of a picture. */
function live(data, roots) {
  Bokeh.embed.embed_items({sheet: data}, [{docid: "sheet", roots, root_ids: Object.keys(roots)}]);
}
