// The page of a running survey: hears server-sent events, shows what they say, and says by itself when
// they stop. Whatever comes is shown as text.
(function () {
  'use strict';
  const head = JSON.parse(document.getElementById('head').textContent);
  const SILENT_MS = 2500;  // without an event the link is dead, without a status the survey is
  const AGAIN_MS = 1500;   // between two attempts to connect
  const NOTICES = 200;     // shown
  const byId = function (id) { return document.getElementById(id); };

  let epoch = null, columns = {}, lastId = '', source = null;
  let heardAt = -1, triedAt = 0, lostAt = null, statusAt = 0;
  let stations = new Map(), parts = new Map();
  let status = null, glance = null, ended = null, samples = null, samplesAt = 0;
  let chartsStale = false;

  function now() { return performance.now(); }
  function text(value) { return value === null || value === undefined ? '' : String(value); }
  function fixed(value, decimals) { return typeof value === 'number' ? value.toFixed(decimals) : '–'; }
  function clock(utime_us) {
    return utime_us ? new Date(utime_us / 1000).toISOString().slice(0, 19).replace('T', ' ') : '';
  }
  function element(name, className, content) {
    const made = document.createElement(name);
    if (className) made.className = className;
    if (content !== undefined) made.textContent = content;
    return made;
  }
  function say(id, content) {
    const at = byId(id);
    if (at.textContent !== content) at.textContent = content;
  }

  // --- the link, in one sentence at the head of the page
  function sentence() {
    const at = now();
    if (lostAt !== null) {
      const since = ' since ' + new Date(lostAt).toISOString().slice(11, 19) + ' UTC';
      if (ended) return ['ended', endSentence() + ' The program is gone.'];
      return ['fail', 'No link to the survey' + since + ': it was stopped, or the way to it is cut. ' +
        'What stands here is old. The page keeps trying.'];
    }
    if (ended) return ['ended', endSentence()];
    if (heardAt < 0) return ['warn', 'Connecting to the survey.'];
    if (at - statusAt > SILENT_MS) return ['fail', 'The survey says nothing: it hangs, or has just begun.'];
    if (samples === 0) return ['warn', 'The survey listens; no samples have come yet.'];
    if (at - samplesAt > SILENT_MS) return ['fail', 'No samples are coming: the tool or its link is silent.'];
    if (status && status.state !== 'ok') return [status.state === 'fault' ? 'fail' : 'warn', 'Running: ' + status.text + '.'];
    return ['pass', 'Running.'];
  }

  function endSentence() { return 'The survey has ended: ' + ended.how + ', verdict ' + ended.verdict + '.'; }

  function showLink() {
    const said = sentence();
    const link = byId('link');
    if (link.className !== 'verdict ' + said[0]) link.className = 'verdict ' + said[0];
    say('link', said[1]);
  }

  function connect() {
    if (source) source.close();
    triedAt = now();
    source = new EventSource('/events' + (lastId ? '?after=' + encodeURIComponent(lastId) : ''));
    const hear = function (name, take) {
      source.addEventListener(name, function (event) {
        heardAt = now();
        lostAt = null;
        if (event.lastEventId) lastId = event.lastEventId;
        if (take) take(JSON.parse(event.data));
        showLink();
      });
    };
    hear('hello', takeHello);
    hear('beat', null);
    hear('station', takeStation);
    hear('glance', takeGlance);
    hear('status', takeStatus);
    hear('advice', takeAdvice);
    hear('survey', takeSurvey);
    hear('notice', takeNotice);
    hear('end', function (end) { ended = end; });
  }

  function watch() {
    const at = now();
    const silent = at - Math.max(heardAt, 0) > SILENT_MS;
    if (silent && lostAt === null) lostAt = Date.now() - SILENT_MS;
    if (silent && at - triedAt > AGAIN_MS) connect();
    showLink();
  }

  // --- what is heard
  // Another run of the program tells all it knows again: what an earlier one said goes.
  function takeHello(hello) {
    columns = {};
    hello.columns.forEach(function (name, i) { columns[name] = i; });
    statusAt = samplesAt = now();
    if (hello.epoch === epoch) return;
    epoch = hello.epoch;
    lastId = '';
    stations = new Map();
    parts = new Map();
    ended = status = glance = samples = null;
    byId('advice').hidden = true;
    ['stations', 'notices', 'checks', 'undone', 'operations'].forEach(function (id) { byId(id).textContent = ''; });
    chartsStale = true;
  }

  function takeStatus(heard) {
    status = heard;
    statusAt = now();
    if (heard.samples_received !== samples) samplesAt = statusAt;
    samples = heard.samples_received;
    say('now-lost', text(heard.samples_lost));
  }

  function takeGlance(heard) {
    glance = heard;
    say('now-md', fixed(heard.md_m, 1));
    say('now-speed', fixed(heard.speed_mps, 2));
    say('now-inc', fixed(heard.inclination_deg, 2));
    say('now-azi', heard.azimuth_true_deg === null ? '–' : fixed(heard.azimuth_true_deg, 2));
    say('now-sigma', heard.azimuth_true_deg === null ? 'no north yet' : '± ' + fixed(heard.sigma_azimuth_deg, 2) + '° one sigma');
    say('now-checks', heard.checks_warned + ' warn, ' + heard.checks_failed + ' fail');
    say('now-turned', heard.turned ? 'last turned: ' + heard.turned : '');
    say('now-time', clock(heard.utime_us));
    const more = heard.rests_s === null ? 0 : heard.rest_needed_s - heard.rests_s;
    say('now-rest', heard.rests_s === null ? 'moving' : fixed(heard.rests_s, 0) + ' s');
    say('now-more', heard.rests_s === null ? '' :
      (more > 0 ? fixed(more, 0) + ' s more for a north' : 'long enough for a north') + asked(heard));
  }

  // Where none is asked for its tile stays away.
  function takeAdvice(heard) {
    const what = { none: 'none', stop: 'Stop here', stay: 'Stay', move_on: 'Move on' }[heard.action];
    const stops = heard.action === 'stop' || heard.action === 'stay';
    byId('advice').hidden = false;
    byId('advice').className = heard.action === 'none' || heard.reachable ? '' : 'fail';
    say('now-advice', what + (stops ? ', ' + fixed(heard.more_s, 0) + ' s' : ''));
    say('now-advised', heard.text);
  }

  // What the gyros' noise alone takes: the least.
  function asked(heard) {
    if (heard.sigma_asked_deg === undefined) return '';
    const of = '± ' + Number(heard.sigma_asked_deg.toPrecision(3)) + '°';
    if (heard.rest_asked_s === null) return heard.inclination_deg === null ? '' : '; no rest gives ' + of + ' here';
    const more = heard.rest_asked_s - heard.rests_s;
    return more > 0 ? '; ' + fixed(more, 0) + ' s more at least for ' + of : '; ' + of + ' as far as noise goes';
  }

  const CELLS = [['MD[m]', 2], ['INC[deg]', 3], ['AZI_TRUE[deg]', 3], ['SIG_INC[deg]', 3], ['SIG_AZI[deg]', 3],
    ['TVD[m]', 2], ['N[m]', 2], ['E[m]', 2], ['RUN', 0], ['PASS'], ['KIND'], ['STATUS'], ['REVISION', 0], ['QUALITY']];

  function takeStation(heard) {
    const before = stations.get(heard.key);
    const line = before ? before.line : document.createElement('tr');
    const at = function (name) { return heard.row[columns[name]]; };
    const quality = text(at('QUALITY'));
    line.dataset.key = heard.key;
    line.className = quality.includes('unfit') || at('STATUS') === 'rejected' ? 'fail' : '';
    line.textContent = '';
    CELLS.forEach(function (cell) {
      const number = cell.length > 1;
      line.append(element('td', number ? 'n' : '', number ? fixed(at(cell[0]), cell[1]) : text(at(cell[0]))));
    });
    if (!before) byId('stations').prepend(line);
    stations.set(heard.key, { at: at, line: line, utime_us: heard.utime_us });
    say('now-stations', text(stations.size));
    if (at('KIND') === 'gyrocompass') showStop();
    chartsStale = true;
  }

  function showStop() {
    let last = null;
    stations.forEach(function (s) {
      if (s.at('KIND') === 'gyrocompass' && (!last || s.utime_us >= last.utime_us)) last = s;
    });
    say('now-stop', 'last: ' + fixed(last.at('AZI_TRUE[deg]'), 2) + ' ± ' + fixed(last.at('SIG_AZI[deg]'), 2) +
      '° at MD ' + fixed(last.at('MD[m]'), 1));
  }

  function takeNotice(heard) {
    const line = element('li', '', '');
    line.append(element('time', '', clock(heard.utime_us).slice(11)), ' ', element('bdi', '', heard.text));
    const list = byId('notices');
    list.prepend(line);
    while (list.childElementCount > NOTICES) list.lastElementChild.remove();
  }

  function takeSurvey(heard) {
    parts.set(heard.part, heard);
    showVerdict();
    showChecks();
    showOperations();
    chartsStale = true;
  }

  const RANK = { fail: 0, warn: 1, pass: 2, not_done: 3 };
  const WORD = { not_done: 'not done' };

  function showVerdict() {
    const worst = Array.from(parts.values()).map(function (p) { return p.verdict; }).filter(Boolean)
      .sort(function (a, b) { return RANK[a.verdict] - RANK[b.verdict]; })[0];
    const word = byId('verdict');
    word.className = 'word ' + (worst ? worst.verdict : '');
    say('verdict', worst ? 'so far: ' + worst.verdict : '');
    say('causes', worst && worst.causes.length ? worst.causes.join('; ') : '');
  }

  function showChecks() {
    const lines = [];
    parts.forEach(function (part, name) {
      const table = part.checks;
      if (!table) return;
      const column = {};
      table.columns.forEach(function (title, i) { column[title] = i; });
      table.rows.forEach(function (row) { lines.push({ part: name, at: function (title) { return row[column[title]]; } }); });
    });
    lines.sort(function (a, b) { return RANK[a.at('VERDICT')] - RANK[b.at('VERDICT')]; });
    const undone = function (check) { return check.at('VERDICT') === 'not_done'; };
    const shown = d3.nest().key(function (check) { return undone(check) ? 'undone' : 'checks'; }).map(lines);
    ['checks', 'undone'].forEach(function (id) { byId(id).replaceChildren(...(shown.get(id) || []).map(lineOf)); });
    say('undone-count', (shown.get('undone') || []).length + ' checks not done, and why');
  }

  function lineOf(check) {
    const verdict = text(check.at('VERDICT'));
    const line = element('tr', verdict);
    line.append(element('td', '', WORD[verdict] || verdict),
      element('td', '', (check.part ? check.part + ' ' : '') + text(check.at('CODE'))),
      element('td', '', text(check.at('RUN') || '')), element('td', '', text(check.at('PASS'))),
      element('td', 'n', fixed(check.at('MD[m]'), 2)));
    ['VALUE', 'SIGMA', 'LIMIT'].forEach(function (name) {
      const value = check.at(name);
      line.append(element('td', 'n', typeof value === 'number' ? String(Number(value.toPrecision(4))) : '–'));
    });
    line.append(element('td', '', text(check.at('UNIT'))), element('td', '', text(check.at('LIMIT_SOURCE'))));
    return line;
  }

  function showOperations() {
    const all = [];
    parts.forEach(function (part) { (part.operation || []).forEach(function (one) { all.push(one); }); });
    byId('operations').replaceChildren(...all.reverse().map(function (one) {
      const line = element('tr', one.obeyed ? '' : 'warn');
      [clock(one.utime_us), one.kind, one.key, one.who, one.obeyed ? 'obeyed' : 'refused', one.effect].forEach(function (cell) {
        const td = element('td');
        td.append(element('bdi', '', text(cell)));
        line.append(td);
      });
      return line;
    }));
  }

  // --- charts
  function byMd() {
    return Array.from(stations.values()).filter(function (s) {
      return s.at('STATUS') !== 'rejected' && typeof s.at('MD[m]') === 'number';
    }).sort(function (a, b) { return a.at('MD[m]') - b.at('MD[m]') || a.utime_us - b.utime_us; });
  }

  // What was measured on each pass of each run, down the hole.
  function passes(all) {
    const groups = d3.nest().key(function (s) { return 'run ' + s.at('RUN') + ' ' + s.at('PASS'); })
      .entries(all.filter(function (s) { return s.at('PASS') !== 'stationary' || s.at('KIND') !== 'tie_in'; }));
    const runs = new Set(all.map(function (s) { return s.at('RUN'); }));
    return groups.map(function (group, i) {
      const pass = group.values[0].at('PASS');
      return { name: runs.size > 1 ? group.key : pass + (pass === 'in' || pass === 'out' ? '-run' : ''),
        stations: group.values, colour: head.colours[i % 4], mark: pass === 'stationary' ? 'dots' : 'line' };
    });
  }

  function seriesOf(group, x, y) {
    return { name: group.name, mark: group.mark, colour: group.colour,
      x: group.stations.map(x), y: group.stations.map(y), md: group.stations.map(function (s) { return s.at('MD[m]'); }) };
  }

  function column(name) { return function (s) { return s.at(name); }; }

  // Azimuths without jumps at north: each as near to the one before as whole turns allow.
  function unwrapped(groups) {
    let before = null;
    return groups.map(function (group) {
      before = null;
      const series = seriesOf(group, column('MD[m]'), function (s) {
        let azimuth = s.at('AZI_TRUE[deg]');
        if (before !== null) azimuth += 360 * Math.round((before - azimuth) / 360);
        before = azimuth;
        return azimuth;
      });
      return series;
    }).map(function (series, i, all) {
      const turns = Math.round((all[0].y[0] - series.y[0]) / 360);
      series.y = series.y.map(function (azimuth) { return azimuth + 360 * turns; });
      return series;
    });
  }

  // The azimuth of the vertical section: to the end of the plan, or to the deepest station.
  function sectionAzimuth(all) {
    const plan = head.plan && head.plan.rows[head.plan.rows.length - 1];
    const last = all[all.length - 1];
    return plan ? Math.atan2(plan[2], plan[1]) : last ? Math.atan2(last.at('E[m]'), last.at('N[m]')) : 0;
  }

  function planned(x, y) {
    if (!head.plan) return [];
    return [{ name: 'plan', mark: 'dash', colour: head.help, md: [], x: head.plan.rows.map(x), y: head.plan.rows.map(y) }];
  }

  function framed(chart) {
    const all = function (axis) { return d3.extent(d3.merge(chart.series.map(function (s) { return s[axis]; }))); };
    const x = all('x'), y = all('y');
    const room = function (extent) { return Math.max(0.05 * (extent[1] - extent[0]), chart.least); };
    chart.low = [x[0] - room(x), y[0] - room(y)];
    chart.high = [x[1] + room(x), y[1] + room(y)];
    return chart;
  }

  function differences(name, sigma) {
    const series = [];
    parts.forEach(function (part) {
      (part.pass_differences || []).forEach(function (pair, i) {
        const column = {};
        pair.columns.forEach(function (title, k) { column[title] = k; });
        const rows = pair.rows.filter(function (row) { return row[column[name]] !== null; });
        const md = rows.map(function (row) { return row[column['MD[m]']]; });
        const of = function (at) { return rows.map(at); };
        series.push({ name: pair.other + ' less ' + pair.first, mark: 'line', colour: head.colours[i % 4], md: md, x: md,
          y: of(function (row) { return row[column[name]]; }) });
        [3, -3].forEach(function (times) {
          series.push({ name: '3 sigma', mark: 'dash', colour: head.help, md: [], x: md,
            y: of(function (row) { return row[column[sigma]] === null ? null : times * row[column[sigma]]; }) });
        });
      });
    });
    return series;
  }

  function allCharts() {
    const all = byMd(), groups = passes(all), towards = sectionAzimuth(all);
    const along = function (north, east) { return north * Math.cos(towards) + east * Math.sin(towards); };
    const degrees = ((towards * 180 / Math.PI) % 360 + 360) % 360;
    return [
      { id: 'plan', title: 'Plan', x: 'east [m]', y: 'north [m]', equal: true, least: 1, height: 380,
        series: planned(function (p) { return p[2]; }, function (p) { return p[1]; })
          .concat(groups.map(function (g) { return seriesOf(g, column('E[m]'), column('N[m]')); })) },
      { id: 'section', title: 'Vertical section towards ' + degrees.toFixed(0) + '°', x: 'along the section [m]', y: 'TVD [m]',
        equal: true, down: true, least: 1, height: 380,
        series: planned(function (p) { return along(p[1], p[2]); }, function (p) { return p[3]; })
          .concat(groups.map(function (g) {
            return seriesOf(g, function (s) { return along(s.at('N[m]'), s.at('E[m]')); }, column('TVD[m]'));
          })) },
      { id: 'inclination', title: 'Inclination', x: 'MD [m]', y: 'inclination [°]', md: true, least: 0.05,
        series: groups.map(function (g) { return seriesOf(g, column('MD[m]'), column('INC[deg]')); }) },
      { id: 'azimuth', title: 'Azimuth, true', x: 'MD [m]', y: 'azimuth [°]', md: true, least: 0.05, series: unwrapped(groups) },
      { id: 'd-inclination', title: 'Inclination, passes compared', x: 'MD [m]', y: 'difference [°]', md: true, least: 0.01,
        series: differences('D_INC[deg]', 'SIG_D_INC[deg]') },
      { id: 'd-azimuth', title: 'Azimuth, passes compared', x: 'MD [m]', y: 'difference [°]', md: true, least: 0.01,
        series: differences('D_AZI[deg]', 'SIG_D_AZI[deg]') },
    ];
  }

  const drawn = {};
  function redraw() {
    if (!chartsStale || document.hidden) return;
    chartsStale = false;
    allCharts().forEach(function (chart) {
      // As wide as it stands on the screen, so that its letters have their size.
      const width = Math.max(300, Math.min(720, byId(chart.id).clientWidth));
      Object.assign(chart, { width: width, height: chart.height || 260, notes: [] });
      if (!chart.series.some(function (s) { return s.x.length; })) return;
      framed(chart);
      if (drawn[chart.id]) drawn[chart.id].update(chart);
      else drawn[chart.id] = charts.draw(byId(chart.id), chart);
    });
  }

  function point(md) {
    const all = byMd();
    const near = d3.scan(all, function (a, b) { return Math.abs(a.at('MD[m]') - md) - Math.abs(b.at('MD[m]') - md); });
    if (near === undefined) return;
    const s = all[near];
    charts.show(s.at('MD[m]'));
    byId('readout').hidden = false;
    say('readout', 'MD ' + fixed(s.at('MD[m]'), 2) + ' m   inclination ' + fixed(s.at('INC[deg]'), 3) + '°   azimuth ' +
      fixed(s.at('AZI_TRUE[deg]'), 3) + '° ± ' + fixed(s.at('SIG_AZI[deg]'), 3) + '°   TVD ' + fixed(s.at('TVD[m]'), 2) +
      ' m   ' + s.at('PASS') + ', ' + s.at('KIND') + ', ' + s.at('STATUS') + ', ' + s.at('QUALITY'));
  }

  const charts = wellgyroCharts({
    unit: 'm', point: point, depths: function () { return byMd().map(function (s) { return s.at('MD[m]'); }); },
  });

  // --- orders
  function order(event) {
    event.preventDefault();
    const asked = new URLSearchParams(new FormData(byId('order')));
    const what = asked.get('what'), weighs = what === 'accept' || what === 'reject';
    if (weighs && !window.confirm('Send ' + what + ' to the survey, signed?')) return;
    byId('send').disabled = true;
    say('answer', 'Sending.');
    fetch('/order', { method: 'POST', headers: { 'X-Wellgyro': 'order' }, body: asked })
      .then(function (answer) { return answer.text(); }, function () { return 'Not sent: no link to the survey.'; })
      .then(function (said) { say('answer', said); byId('send').disabled = false; });
  }
  if (byId('order')) byId('order').addEventListener('submit', order);

  document.addEventListener('visibilitychange', redraw);
  connect();
  setInterval(watch, 250);
  setInterval(redraw, 1000);
})();
