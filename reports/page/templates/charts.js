(() => {
  const axis = { domainColor: "var(--pale)", tickColor: "var(--pale)", gridColor: "var(--grid)", gridWidth: 0.6,
    labelColor: "var(--ink)", titleColor: "var(--ink)", labelFontSize: 12, titleFontSize: 12.5, titleFontWeight: 400,
    titlePadding: 8 };
  const config = { background: null, font: "system-ui, 'DejaVu Sans', Verdana, sans-serif", axis, view: { stroke: null },
    legend: { labelColor: "var(--ink)", titleColor: "var(--ink)", labelFontSize: 12, titleFontSize: 12,
      titleFontWeight: 400, columnPadding: 16, rowPadding: 3 } };
  const narrow = 560;
  // Vega-Lite takes a click on any mark as one more on the name of the legend that was clicked last: without that.
  const patch = spec => {
    spec.signals.filter(signal => signal.name.endsWith("_legend")).forEach(signal => { signal.on = signal.on.slice(0, 1); });
    return spec;
  };
  const formatTooltip = (shown, escape) => `<table>${Object.entries(shown)
    .filter(([, text]) => text !== "null" && text !== "undefined")
    .map(([name, text]) => `<tr><td class="key">${escape(name)}</td><td class="value">${escape(text)}</td></tr>`)
    .join("")}</table>`;
  const options = { mode: "vega-lite", renderer: "svg", actions: false, config, patch, tooltip: { theme: "page", formatTooltip } };
  const draw = async (chart, { csv, spec }) => {
    chart.querySelector("a.csv").href = csv;
    chart.view?.finalize();
    const place = chart.querySelector(".vega"), direction = place.clientWidth < narrow ? "vertical" : "horizontal";
    config.legend.layout = { top: { anchor: "start", direction, margin: direction === "vertical" ? 2 : 14 } };
    chart.view = (await vegaEmbed(place, spec, options)).view;
    chart.dataset.drawn = csv;
  };
  const start = chart => {
    const specs = JSON.parse(chart.querySelector("script").textContent), select = chart.querySelector("select");
    select?.addEventListener("change", () => draw(chart, specs[select.selectedIndex]));
    return draw(chart, specs[select?.selectedIndex ?? 0]);
  };
  const seen = new IntersectionObserver(entries => entries.filter(entry => entry.isIntersecting).forEach(({ target }) => {
    seen.unobserve(target);
    start(target).catch(error => { hideCharts(); throw error; });
  }), { rootMargin: "300px" });
  document.querySelectorAll(".chart").forEach(chart => seen.observe(chart));
})();
