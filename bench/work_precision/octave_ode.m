% Octave's ode15s on the problem of a scene: usage octave_ode.m PROBLEM.json FOLDER full|quick|start. Prints as scipy_ode.py.
1;

function [rate, volts] = respond(t, y, p, start, lines)
  x = y(1) * 1e-3;
  v = y(2);
  force = p.load - p.damping * v;
  rate = zeros(size(y));
  rate(1) = v / 1e-3;
  volts = zeros(1, p.n);
  at = 3;
  for k = 1:p.n
    lam = p.lp1 * (1 + p.side(k) * x / p.length(k));
    i1 = lam^2 + p.lp2^2 + 1 / (lam * p.lp2)^2;
    stress = p.mu * p.jm * (lam - 1 / (lam^3 * p.lp2^2)) / (p.jm + 3 - i1);
    if p.b > 0
      a = y(at:2:at + 2 * p.b - 2);
      b = y(at + 1:2:at + 2 * p.b - 1);
      g1 = (lam ./ (p.lp1 * a)).^2;
      g2 = 1 ./ b.^2;
      g3 = 1 ./ (g1 .* g2);
      s1 = g1 - g3;
      s2 = g2 - g3;
      stress += sum(p.bmu .* s1) / lam;
      rate(at:2:at + 2 * p.b - 2) = a .* (s1 - 0.5 * s2) ./ (3 * p.btau);
      rate(at + 1:2:at + 2 * p.b - 1) = b .* (s2 - 0.5 * s1) ./ (3 * p.btau);
      at += 2 * p.b;
    end
    c = p.eps * p.width * p.length(k) * lam^2 / (p.lp1^2 * p.thickness);
    volts(k) = y(at) * 1e-7 / c;
    force -= p.side(k) * (p.width * p.thickness * p.lp1 * stress - volts(k)^2 * p.eps * p.width * lam / (p.lp1 * p.thickness));
    rate(at) = (lines(k, 1) + lines(k, 2) * (t - start) - volts(k)) / p.resistance(k) / 1e-7;
    at += 1;
  end
  rate(2) = force / p.mass;
end

function rate = count_calls(t, y, p, start, lines)
  global calls
  calls += 1;
  rate = respond(t, y, p, start, lines);
end

function rows = solve(p, corners, spans, rtol)
  y = p.initial;
  rows = [0, y'];
  times = linspace(0, p.stop, p.rows + 1)';
  options = odeset("RelTol", rtol, "AbsTol", rtol * 1e-2);
  for s = 1:numel(spans) - 1
    start = spans(s);
    finish = spans(s + 1);
    lines = zeros(p.n, 2);
    for k = 1:p.n
      c = corners{k};
      at = find(c(:, 1) <= start & start < c(:, 3), 1);
      slope = (c(at, 4) - c(at, 2)) / (c(at, 3) - c(at, 1));
      lines(k, :) = [c(at, 2) + slope * (start - c(at, 1)), slope];
    end
    near = 1e-9 * p.stop; # closer times are one, or ode15s fails between them
    inside = times(times > start + near & times < finish - near);
    if isempty(inside)
      inside = 0.5 * (start + finish);
    end
    [t, got] = ode15s(@(t, y) count_calls(t, y, p, start, lines), [start; inside; finish], y, options);
    if t(end) < finish
      error("ode15s stopped at %g", t(end));
    end
    rows = [rows; t(2:end), got(2:end, :)];
    y = got(end, :)';
  end
end

warning("off", "all");
given = argv();
folder = given{end - 1};
scope = given{end};
raw = jsondecode(fileread(given{end - 2}));
p = struct("stop", raw.stop, "rows", raw.rows, "width", raw.width, "thickness", raw.thickness, "lp1", raw.lp1, ...
           "lp2", raw.lp2, "mu", raw.mu, "jm", raw.jm, "eps", raw.permittivity, "mass", raw.mass, ...
           "damping", raw.damping, "load", raw.load, "n", numel(raw.zones), "b", numel(raw.branches));
p.side = [raw.zones.side];
p.length = [raw.zones.length];
p.resistance = [raw.zones.resistance];
if p.b > 0
  p.bmu = [raw.branches.mu]';
  p.btau = [raw.branches.tau]';
end
p.initial = [0; 0; repmat([ones(2 * p.b, 1); 0], p.n, 1)];
corners = cell(1, p.n);
spans = [];
for k = 1:p.n
  corners{k} = reshape(raw.zones(k).corners, [], 4);
  spans = [spans; corners{k}(:, 1); corners{k}(:, 3)];
end
spans = unique(spans);

if strcmp(scope, "start")
  exit(0);
end
global calls
tolerances = 10 .^ -(3:7);
repeats = 5;
if strcmp(scope, "quick")
  tolerances = [1e-3, 1e-5];
  repeats = 1;
end
for rtol = tolerances
  try
    seconds = [];
    while numel(seconds) < repeats && sum(seconds) < 1.5
      calls = 0;
      started = tic();
      rows = solve(p, corners, spans, rtol);
      seconds(end + 1) = toc(started);
    end
    file = fopen(sprintf("%s/octave_ode15s-%g.txt", folder, rtol), "w");
    for i = 1:size(rows, 1)
      [~, volts] = respond(rows(i, 1), rows(i, 2:end)', p, 0, zeros(p.n, 2));
      fprintf(file, "%.17g", rows(i, 1));
      fprintf(file, " %.17g", rows(i, 2) * 1e-3, volts);
      fprintf(file, "\n");
    end
    fclose(file);
    printf("octave_ode15s %g %d", rtol, calls);
    printf(" %.6g", seconds);
    printf("\n");
    fflush(stdout);
  catch failure
    printf("octave_ode15s %g failed %s\n", rtol, strrep(failure.message, "\n", " "));
  end
end
