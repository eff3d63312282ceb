// Draws the report's charts again so that they can be zoomed and read, the station under the depth
// cursor at the foot of the page. What is drawn stands in the page as JSON.
(function () {
  'use strict';
  const page = JSON.parse(document.getElementById('charts').textContent);
  const survey = JSON.parse(document.getElementById('survey').textContent);
  const readout = document.getElementById('readout');

  // Stations by depth, in the page's unit of length.
  const columns = {};
  survey.stations.columns.forEach(function (name, i) { columns[name] = i; });
  const stations = survey.stations.rows.map(function (row) {
    const at = function (name) { return row[columns[name]]; };
    return { md: at('MD[m]') * page.length, row: at };
  });
  const bisect = d3.bisector(function (s) { return s.md; }).left;

  function nearestStation(md) {
    const i = bisect(stations, md);
    const before = stations[i - 1], after = stations[i];
    if (!before || !after) return before || after;
    return md - before.md < after.md - md ? before : after;
  }

  function fixed(value, decimals) {
    return value === null || value === undefined ? 'none' : value.toFixed(decimals);
  }

  function tell(station) {
    const length = function (name) { return fixed(station.row(name) * page.length, 2) + ' ' + page.unit; };
    readout.hidden = false;
    readout.textContent = 'MD ' + length('MD[m]') + '   inclination ' + fixed(station.row('INC[deg]'), 3) +
      '°   azimuth ' + fixed(station.row('AZI_TRUE[deg]'), 3) + '°   TVD ' + length('TVD[m]') +
      '   north ' + length('N[m]') + '   east ' + length('E[m]') + '   σ inclination ' +
      fixed(station.row('SIG_INC[deg]'), 3) + '°   σ azimuth ' + fixed(station.row('SIG_AZI[deg]'), 3) +
      '°   ' + station.row('KIND') + ', ' + station.row('QUALITY');
  }

  // The cursor of depth, in every chart.
  function point(md) {
    const station = nearestStation(md);
    if (!station) return;
    charts.show(station.md);
    tell(station);
  }

  const charts = wellgyroCharts({
    unit: page.unit,
    depths: function () { return stations.map(function (s) { return s.md; }); },
    point: point,
  });
  page.charts.forEach(function (chart) {
    const figure = document.getElementById(chart.id);
    if (figure) charts.draw(figure, chart);
  });
  document.documentElement.setAttribute('data-drawn', String(charts.count()));
})();
