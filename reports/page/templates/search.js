(() => {
  const field = document.getElementById("search"), list = document.getElementById("search-list");
  if (!field) return;
  let wanted = false;
  const load = () => {
    if (wanted) return;
    wanted = true;
    const script = document.createElement("script");
    script.src = "search.js";
    script.onload = show;
    document.head.append(script);
  };
  const show = () => {
    const words = field.value.toLowerCase().split(/\s+/).filter(Boolean), rank = { title: 0, figure: 1, case: 2 };
    const matches = !window.ENTRIES || !words.length ? [] : window.ENTRIES.filter(([text, kind]) =>
      words.every(word => (text + " " + kind).toLowerCase().includes(word)));
    matches.sort((a, b) => (rank[a[1]] ?? 3) - (rank[b[1]] ?? 3) || a[0].length - b[0].length);
    list.replaceChildren(...matches.slice(0, 20).map(([text, kind, address]) => {
      const item = document.createElement("li"), link = document.createElement("a"), small = document.createElement("span");
      link.href = address;
      link.textContent = text;
      link.addEventListener("click", () => { list.hidden = true; });
      small.textContent = " " + kind;
      item.append(link, small);
      return item;
    }));
    if (words.length && window.ENTRIES && !matches.length) list.textContent = "Nothing found.";
    list.hidden = !words.length;
  };
  field.addEventListener("focus", load);
  field.addEventListener("input", () => { load(); show(); });
  field.addEventListener("keydown", event => {
    const first = list.querySelector("a");
    if (event.key === "Enter" && first) first.click();
    if (event.key === "Escape") list.hidden = true;
  });
})();
