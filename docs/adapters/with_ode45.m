% Follow the reference cases with ode45 of GNU Octave or MATLAB, and write the events that it finds.
%
%   octave-cli with_ode45.m cases/cases.csv mine.csv paper,easy
%   symosc score cases mine.csv
%
% Run with GNU Octave 7. For MATLAB put the functions at the end of the file, and `words = {...}` in place of argv().
% The third argument names groups, with commas between them; without it all groups are followed. A mode of motion (a
% domain, or a stick) is integrated up to its terminal event; the forces at the belt decide what happens there. Steps are
% short beside the forcing period, because ode45 sees an event by a change of sign only. Octave's ode45 places an event
% by a straight line through the step, which is good to three digits; so the time is improved here by the secant rule.
% Cases that take longer than 20 seconds of processor time are left out.

1;  % a script, which may define functions

function a = force(p, domain, t, x, v)
  % The acceleration that a domain gives.
  friction = [p.mu1 + p.mu2, p.mu2 - p.mu1, -p.mu1 - p.mu2];
  a = (p.A0 + friction(domain) * p.FN + p.B0 * cos(p.Omega * t) - p.k * x - p.c * v) / p.m;
end

function check_time(p)
  if cputime() - p.begun > p.limit, error('more than %g seconds', p.limit); end
end

function [value, ends, direction] = contact(p, domain, y)
  % Distances from both belts; v rises to the belt above the domain and falls to the one below.
  check_time(p);
  value = [y(2) - p.v1; y(2) - p.v2];
  ends = [1; 1] .* [domain < 3; domain > 1];
  direction = [2 * (domain == 1) - 1; 2 * (domain < 3) - 1];
end

function [value, ends, direction] = release(p, belt, t, x)
  % The forces below and above a belt; a stick ends where the first falls to 0 or the second rises to 0.
  check_time(p);
  v = p.speeds(belt);
  value = [force(p, belt, t, x, v); force(p, belt + 1, t, x, v)];
  ends = [1; 1];
  direction = [-1; 1];
end

function [t, y, which] = advance(p, rates, events, t, y)
  % Integrate up to the first event; which is its number, 0 at the end.
  longest = 0.05 * 2 * pi / p.Omega;
  settings = odeset('RelTol', 1e-11, 'AbsTol', 1e-11, 'Refine', 1, 'MaxStep', longest, 'InitialStep', longest / 100);
  [times, states, te, ye, ie] = ode45(rates, [t, p.t_end], y, odeset(settings, 'Events', events));
  t = times(end);
  y = states(end, :)';
  which = 0;
  if isempty(ie), return; end
  which = ie(end);
  from = find(times < te(end), 1, 'last');  % the secant rule, from the last step before the event
  a = times(from);
  ya = states(from, :)';
  fa = pick(events(a, ya), which);
  t = te(end);
  last = a;
  fb = fa;
  for i = 1:6
    [~, found] = ode45(rates, [a, t], ya, odeset(settings, 'InitialStep', (t - a) / 4));  % a longer one goes beyond t
    y = found(end, :)';
    f = pick(events(t, y), which);
    if f == fb || abs(t - last) < 1e-15 * max(1, abs(t)), break; end
    next = t - f * (t - last) / (f - fb);
    last = t;
    fb = f;
    if ~(next > a && next < p.t_end), break; end
    t = next;
  end
end

function value = pick(values, i)
  value = values(i);
end

function rows = follow(p)
  % The events of a case, a row each: t, x, kind (1 cross, 2 stick, 3 slip), belt.
  rows = zeros(0, 4);
  t = p.t0;
  y = [p.x0; p.v0];
  p.speeds = [p.v1, p.v2];
  belt = find(p.v0 == p.speeds);
  domain = 1 + sum(p.v0 > p.speeds);
  while t < p.t_end
    if ~isempty(belt)
      y(2) = p.speeds(belt);
      below = force(p, belt, t, y(1), y(2));
      above = force(p, belt + 1, t, y(1), y(2));
      if below > 0 && above < 0
        if t > p.t0, rows(end + 1, :) = [t, y(1), 2, belt]; end
        [t, x, which] = advance(p, @(t, x) y(2), @(t, x) release(p, belt, t, x), t, y(1));
        if which == 0, return; end
        y(1) = x;
        domain = belt + which - 1;
        rows(end + 1, :) = [t, y(1), 3, belt];
      else
        before = domain;
        domain = belt + (above >= 0);
        if t > p.t0 && domain ~= before, rows(end + 1, :) = [t, y(1), 1, belt]; end
      end
    end
    rates = @(t, y) [y(2); force(p, domain, t, y(1), y(2))];
    [t, y, belt] = advance(p, rates, @(t, y) contact(p, domain, y), t, y);
    if belt == 0, return; end
  end
end

function value = number(text)
  % "0.8", "1e-9" or "4/5".
  parts = strsplit(text, '/');
  value = str2double(parts{1});
  if numel(parts) == 2, value = value / str2double(parts{2}); end
end

warning('off', 'integrate_adaptive:unexpected_termination');  % Octave warns of each event
words = argv();
lines = strsplit(strtrim(fileread(words{1})), "\n");
heads = strsplit(lines{1}, ',');
out = fopen(words{2}, 'w');
fprintf(out, "case,t,x,kind,boundary,seconds\n");
kinds = {'cross', 'stick', 'slip'};
for i = 2:numel(lines)
  cells = cell2struct(strsplit(lines{i}, ',', 'CollapseDelimiters', false), heads, 2);
  if ~strcmp(cells.periods, '0') || (numel(words) > 2 && ~any(strcmp(cells.group, strsplit(words{3}, ','))))
    continue;
  end
  p = struct();
  for name = {'m', 'c', 'k', 'A0', 'B0', 'Omega', 'v1', 'v2', 'mu1', 'mu2', 'FN', 't0', 'x0', 'v0', 't_end'}
    p.(name{1}) = number(cells.(name{1}));
  end
  p.begun = cputime();
  p.limit = 20;
  try
    rows = follow(p);
  catch failure
    fprintf(2, "%s is left out: %s\n", cells.name, failure.message);
    continue;
  end
  for j = 1:size(rows, 1)
    fprintf(out, "%s,%.17g,%.17g,%s,%d,\n", cells.name, rows(j, 1), rows(j, 2), kinds{rows(j, 3)}, rows(j, 4));
  end
  fprintf(out, "%s,%.17g,,end,,%.3g\n", cells.name, p.t_end, cputime() - p.begun);
end
fclose(out);
