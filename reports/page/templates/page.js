const foldsOpenedForPrint = [];
const openFolds = () => document.querySelectorAll("details:not([open])").forEach(fold => {
  fold.open = true;
  foldsOpenedForPrint.push(fold);
});
const closeFolds = () => foldsOpenedForPrint.splice(0).forEach(fold => { fold.open = false; });
addEventListener("beforeprint", openFolds);
addEventListener("afterprint", closeFolds);
matchMedia("print").addEventListener("change", event => event.matches ? openFolds() : closeFolds());
// Called behind a chart and its drawings: the chart is shown, the drawings are folded.
const showCharts = script => {
  const drawings = script.previousElementSibling;
  drawings.open = false;
  drawings.previousElementSibling.hidden = false;
};
const hideCharts = () => {
  document.querySelectorAll(".chart").forEach(chart => { chart.hidden = true; });
  document.querySelectorAll(".drawings").forEach(fold => { fold.open = true; });
};
