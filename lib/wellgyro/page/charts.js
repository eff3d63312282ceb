// Charts that can be zoomed and read, with one depth cursor through all of them. `page` is what they
// stand in: `unit` of length, `depths()` of the stations in their order, `point(md)` when the reader
// points at a depth. A chart is what chart_json_internal.cpp writes.
function wellgyroCharts(page) {
  'use strict';
  const margin = { left: 64, right: 14, top: 44, bottom: 42 };
  const drawn = [];

  function attributes(node, series) {
    if (series.mark === 'dots') return node.attr('fill', series.colour);
    node.attr('stroke', series.colour).attr('fill', 'none');
    if (series.mark === 'line') node.attr('stroke-width', 1.5);
    if (series.mark === 'dash') node.attr('stroke-dasharray', '5 3');
    if (series.mark === 'flag') node.attr('stroke-width', 2);
    if (series.mark === 'area') node.attr('fill', series.colour).attr('fill-opacity', 0.15).attr('stroke-width', 0.8);
    return node;
  }

  function isRound(series) { return series.mark === 'dots' || series.mark === 'flag'; }

  function pathOf(series, x, y) {
    const path = d3.line().defined(function (i) { return series.x[i] !== null && series.y[i] !== null; })
      .x(function (i) { return x(series.x[i]).toFixed(1); }).y(function (i) { return y(series.y[i]).toFixed(1); });
    const line = path(d3.range(series.x.length));
    return line === null ? '' : line + (series.mark === 'area' ? 'Z' : '');
  }

  function drawLegend(svg, chart, left) {
    svg.selectAll('*').remove();
    let x = left;
    const told = {};
    chart.series.forEach(function (series) {
      if (!series.name || told[series.name]) return;
      told[series.name] = true;
      const group = attributes(svg.append('g'), series);
      if (isRound(series)) {
        group.append('circle').attr('cx', x + 9).attr('cy', 31).attr('r', series.mark === 'flag' ? 5 : 3);
      } else {
        group.append('path').attr('d', series.mark === 'area' ? 'M' + x + ' 28h18v6h-18Z' : 'M' + x + ' 31h18');
      }
      svg.append('text').attr('x', x + 23).attr('y', 35).text(series.name);
      x += 40 + 6 * series.name.length;
    });
  }

  // The same frame as the picture that stands in the page: equal scales widen the smaller side.
  function domains(chart, width, height) {
    const low = chart.low.slice(), high = chart.high.slice();
    if (chart.equal) {
      const per = Math.max((high[0] - low[0]) / width, (high[1] - low[1]) / height);
      [width, height].forEach(function (pixels, axis) {
        const middle = (low[axis] + high[axis]) / 2;
        low[axis] = middle - per * pixels / 2;
        high[axis] = middle + per * pixels / 2;
      });
    }
    return [[low[0], high[0]], [low[1], high[1]]];
  }

  function frame(figure, chart, left, bottom) {
    const svg = d3.select(figure).html('').append('svg')
      .attr('viewBox', '0 0 ' + chart.width + ' ' + chart.height)
      .attr('role', 'img').attr('aria-label', chart.title)
      .attr('font-family', 'sans-serif').attr('font-size', 11).attr('fill', '#222');
    svg.append('rect').attr('width', chart.width).attr('height', chart.height).attr('fill', '#fff');
    svg.append('text').attr('x', left).attr('y', 16).attr('font-size', 13).attr('font-weight', 'bold').text(chart.title);
    const width = chart.width - margin.right - left, height = chart.height - bottom - margin.top;
    const clip = 'clip-' + chart.id;
    svg.append('clipPath').attr('id', clip).append('rect').attr('x', left).attr('y', margin.top)
      .attr('width', width).attr('height', height);
    const axes = svg.append('g');
    svg.append('rect').attr('x', left).attr('y', margin.top).attr('width', width).attr('height', height)
      .attr('fill', 'none').attr('stroke', '#777');
    const plot = svg.append('g').attr('clip-path', 'url(#' + clip + ')');
    const legend = svg.append('g');
    drawLegend(legend, chart, left);
    return { svg: svg, plot: plot, axes: axes, legend: legend, left: left, width: width, height: height };
  }

  function drawSeries(plot, chart, x, y) {
    plot.selectAll('*').remove();
    chart.series.forEach(function (series) {
      const group = attributes(plot.append('g'), series);
      if (!isRound(series)) {
        group.append('path').attr('d', pathOf(series, x, y));
        return;
      }
      let dots = '';
      series.x.forEach(function (value, i) {
        if (value === null || series.y[i] === null) return;
        const at = [x(value).toFixed(1), y(series.y[i]).toFixed(1)];
        if (series.mark === 'flag') group.append('circle').attr('cx', at[0]).attr('cy', at[1]).attr('r', 6);
        else dots += 'M' + at[0] + ' ' + at[1] + 'h0';
      });
      // One path of round ends is a fraction of as many circles.
      if (dots) group.append('path').attr('d', dots).attr('fill', 'none').attr('stroke', series.colour)
        .attr('stroke-width', 4.4).attr('stroke-linecap', 'round');
    });
    chart.notes.forEach(function (note) {
      plot.append('text').attr('x', x(note.x) + 7).attr('y', y(note.y) - 4).text(note.text);
    });
  }

  // Where a line passes a depth: at its points, and on its way from one to the next. Along time a
  // tool is at one depth more than once.
  function passesOf(series, md) {
    const places = [], near = 1e-6 * Math.max(1, Math.abs(md));
    series.md.forEach(function (from, i) {
      const to = series.md[i + 1], last = i + 1 === series.md.length;
      if ([from, series.x[i], series.y[i]].includes(null)) return;
      if (Math.abs(from - md) <= near) { places.push([series.x[i], series.y[i]]); return; }
      if (last || [to, series.x[i + 1], series.y[i + 1]].includes(null)) return;
      if (Math.abs(to - md) <= near || (from - md) * (to - md) > 0) return;
      const t = (md - from) / (to - from);
      places.push([series.x[i] + t * (series.x[i + 1] - series.x[i]),
        series.y[i] + t * (series.y[i + 1] - series.y[i])]);
    });
    return places;
  }

  // Where the cursor of depth stands in a chart: on its first line that reaches this depth.
  function placesOf(chart, md) {
    for (const series of chart.series) {
      if (series.mark !== 'line') continue;
      const places = passesOf(series, md);
      if (places.length) return places;
    }
    return [];
  }

  function cursorOf(chart, parts, scales) {
    const line = parts.svg.append('line').attr('class', 'cursor').attr('visibility', 'hidden')
      .attr('clip-path', 'url(#clip-' + chart.id + ')');
    const dots = parts.svg.append('g').attr('clip-path', 'url(#clip-' + chart.id + ')');
    return function (md) {
      if (chart.md) {
        const at = scales.x(md);
        line.attr('x1', at).attr('x2', at).attr('y1', margin.top).attr('y2', margin.top + parts.height)
          .attr('visibility', 'visible');
      }
      const here = dots.selectAll('circle').data(placesOf(chart, md));
      here.exit().remove();
      here.enter().append('circle').attr('class', 'here').attr('r', 4).merge(here)
        .attr('cx', function (at) { return scales.x(at[0]); })
        .attr('cy', function (at) { return scales.y(at[1]); });
    };
  }

  // Of the series with depths, the depth of the point nearest to a place on the paper.
  function depthAt(chart, scales, at) {
    if (chart.md) return scales.x.invert(at[0]);
    let best = null, least = 1e9;
    chart.series.forEach(function (series) {
      series.md.forEach(function (md, i) {
        if ([md, series.x[i], series.y[i]].includes(null)) return;
        const distance = Math.hypot(scales.x(series.x[i]) - at[0], scales.y(series.y[i]) - at[1]);
        if (distance < least) { least = distance; best = md; }
      });
    });
    return least < 40 ? best : null;
  }

  function listen(figure, chart, parts, scales) {
    parts.svg.on('mousemove', function () {
      const md = depthAt(chart, scales, d3.mouse(parts.svg.node()));
      if (md !== null) page.point(md);
    });
    let at = 0;
    d3.select(figure).on('keydown', function () {
      const step = { ArrowRight: 1, ArrowDown: 1, ArrowLeft: -1, ArrowUp: -1 }[d3.event.key];
      const depths = page.depths();
      if (!step || !depths.length) return;
      d3.event.preventDefault();
      at = Math.max(0, Math.min(depths.length - 1, at + step));
      page.point(depths[at]);
    });
  }

  function axisPart(parts, call, x, y) {
    const group = parts.axes.append('g').attr('transform', 'translate(' + x + ',' + y + ')').call(call);
    group.select('.domain').remove();
    group.selectAll('line').attr('stroke', '#e2e2e2');
    group.selectAll('text').attr('fill', '#222').attr('font-size', 11).attr('font-family', 'sans-serif');
  }

  function drawAxes(chart, parts, scales) {
    parts.axes.selectAll('*').remove();
    const bottom = margin.top + parts.height;
    axisPart(parts, d3.axisBottom(scales.x).ticks(parts.width / 80).tickSize(-parts.height).tickPadding(8), 0, bottom);
    axisPart(parts, d3.axisLeft(scales.y).ticks(parts.height / 40).tickSize(-parts.width).tickPadding(6), parts.left, 0);
    parts.axes.append('text').attr('x', parts.left + parts.width / 2).attr('y', bottom + 34)
      .attr('text-anchor', 'middle').text(chart.x);
    parts.axes.append('text').attr('transform', 'translate(14,' + (margin.top + parts.height / 2) + ') rotate(-90)')
      .attr('text-anchor', 'middle').text(chart.y);
  }

  function drawBar(parts, scales) {
    const per = (scales.x.domain()[1] - scales.x.domain()[0]) / parts.width;
    const step = d3.tickIncrement(0, 90 * per, 1);
    const length = step < 0 ? -1 / step : step;
    const y = margin.top + parts.height - 12;
    parts.plot.append('path').attr('d', 'M' + (parts.left + 12) + ' ' + y + 'v4h' + (length / per).toFixed(1) + 'v-4')
      .attr('fill', 'none').attr('stroke', '#222');
    parts.plot.append('text').attr('x', parts.left + 12).attr('y', y - 4).text(length + ' ' + page.unit);
  }

  // The wheel zooms only with Ctrl or where the chart has the focus, so that the page scrolls.
  function zooms(figure, parts, redraw) {
    const zoom = d3.zoom().scaleExtent([1, 400])
      .filter(function () {
        return d3.event.type !== 'wheel' || d3.event.ctrlKey || document.activeElement === figure;
      })
      .translateExtent([[0, 0], [parts.left + parts.width + margin.right, margin.top + parts.height + margin.bottom]])
      .on('zoom', function () { redraw(d3.event.transform); });
    parts.svg.call(zoom);
  }

  function hasPoints(chart) { return chart.series.some(function (s) { return s.x.length; }); }

  // What is drawn can be given other series later, and keeps the reader's zoom then.
  function drawChart(figure, chart) {
    if (!hasPoints(chart)) return null;
    const parts = frame(figure, chart, margin.left, margin.bottom);
    const across = [parts.left, parts.left + parts.width], down = [margin.top, margin.top + parts.height];
    const scales = {};
    let x, y;
    const fit = function () {
      const domain = domains(chart, parts.width, parts.height);
      x = d3.scaleLinear().domain(domain[0]).range(across);
      y = d3.scaleLinear().domain(domain[1]).range(chart.down ? down : down.slice().reverse());
    };
    const redraw = function (transform) {
      scales.x = transform.rescaleX(x);
      scales.y = chart.md ? y : transform.rescaleY(y);
      drawAxes(chart, parts, scales);
      drawSeries(parts.plot, chart, scales.x, scales.y);
      if (chart.equal) drawBar(parts, scales);
    };
    fit();
    redraw(d3.zoomIdentity);
    zooms(figure, parts, redraw);
    const one = { show: cursorOf(chart, parts, scales) };
    one.update = function (next) {
      Object.assign(chart, next, { width: chart.width, height: chart.height });
      drawLegend(parts.legend, chart, parts.left);
      fit();
      redraw(d3.zoomTransform(parts.svg.node()));
    };
    drawn.push(one);
    listen(figure, chart, parts, scales);
    return one;
  }

  // Seen from a distance: turned about the vertical, then tilted towards the reader.
  function seen(points, turn, tilt) {
    const x = [], y = [];
    for (let i = 0; i < points.length; i += 3) {
      const right = Math.cos(turn) * points[i] + Math.sin(turn) * points[i + 1];
      const away = -Math.sin(turn) * points[i] + Math.cos(turn) * points[i + 1];
      x.push(right);
      y.push(Math.sin(tilt) * away - Math.cos(tilt) * points[i + 2]);
    }
    return { x: x, y: y };
  }

  function drawSpace(figure, chart) {
    const parts = frame(figure, chart, margin.right, margin.right);
    const across = [parts.left, parts.left + parts.width], down = [margin.top + parts.height, margin.top];
    const radians = Math.PI / 180;
    let turn = chart.space.turn_deg * radians, tilt = chart.space.tilt_deg * radians;
    const scales = {};
    const redraw = function () {
      chart.series.forEach(function (series, i) { Object.assign(series, seen(chart.space.points[i], turn, tilt)); });
      chart.notes.forEach(function (note, i) {
        const at = seen(chart.space.notes[i], turn, tilt);
        note.x = at.x[0];
        note.y = at.y[0];
      });
      const all = function (axis) { return d3.extent(d3.merge(chart.series.map(function (s) { return s[axis]; }))); };
      const x = all('x'), y = all('y'), room = 0.04 * Math.max(x[1] - x[0], y[1] - y[0]) + 1e-9;
      const domain = domains({ equal: true, low: [x[0] - room, y[0] - room], high: [x[1] + room, y[1] + room] },
        parts.width, parts.height);
      scales.x = d3.scaleLinear().domain(domain[0]).range(across);
      scales.y = d3.scaleLinear().domain(domain[1]).range(down);
      drawSeries(parts.plot, chart, scales.x, scales.y);
    };
    redraw();
    parts.svg.call(d3.drag().on('drag', function () {
      turn -= d3.event.dx * 0.01;
      tilt = Math.max(-1.5, Math.min(1.5, tilt + d3.event.dy * 0.01));
      redraw();
    }));
    const one = { show: cursorOf(chart, parts, scales) };
    drawn.push(one);
    listen(figure, chart, parts, scales);
    return one;
  }

  return {
    draw: function (figure, chart) { return chart.space ? drawSpace(figure, chart) : drawChart(figure, chart); },
    show: function (md) { drawn.forEach(function (one) { one.show(md); }); },
    count: function () { return drawn.length; },
  };
}
