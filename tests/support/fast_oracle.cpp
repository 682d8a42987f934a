// The oracle of oracle.py in quadruple precision: some hundred times faster, with 30 digits. It judges what
// tests/fuzz.py draws; where it differs from the engine, oracle.py decides.
//
// One problem per line on stdin: c/m k/m B0/m Omega A1/m A2/m A3/m v1 v2 x0 v0 cos(Omega t0) sin(Omega t0) span most
// On stdout: one line "event t x kind boundary source target" per event, then "end mode t x v". Times count from t0.
#include <quadmath.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <iostream>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

using Number = __float128;
using Series = std::vector<Number>;

const double REACH = 2.0;           // the fastest rate times a step
const int ORDER = 44;               // REACH^ORDER / ORDER! is 1e-41
const int MAX_DERIVATIVE = 6;       // derivatives that are tried for a constant sign before a step is halved
const int MAX_G = 12;               // G-functions that are tried before a contact is called an equilibrium
const Number RELATIVE = 1e-27Q;     // what counts as zero, as a part of the scale of the forces
enum Kind { NONE, CONTACT, GRAZE };

struct Root {
  Number s;
  Kind kind;
};

Number horner(const Series& series, Number s) {
  Number total = 0;
  for (size_t n = series.size(); n-- > 0;) total = total * s + series[n];
  return total;
}

Series differentiate(const Series& series) {
  Series slope;
  for (size_t n = 1; n < series.size(); n++) slope.push_back(Number(n) * series[n]);
  return slope;
}

// Newton's method kept inside a bracket.
Number polish(const Series& series, const Series& slope, Number low, Number high, bool starts_positive) {
  Number s = (low + high) / 2;
  for (int i = 0; i < 400; i++) {
    Number value = horner(series, s);
    ((value > 0) == starts_positive ? low : high) = s;
    Number steepness = horner(slope, s);
    Number next = steepness != 0 ? s - value / steepness : low;
    if (!(low < next && next < high)) next = (low + high) / 2;
    if (fabsq(next - s) <= FLT128_EPSILON * s || high - low <= FLT128_EPSILON * high) return next;
    s = next;
  }
  return s;
}

// Roots of a series that is monotone between the cuts. Touches within the tolerance count if it is not negative.
std::vector<Root> monotone_roots(const Series& series, const std::vector<Number>& cuts, Number tolerance) {
  std::vector<Number> points{0};
  points.insert(points.end(), cuts.begin(), cuts.end());
  points.push_back(1);
  std::vector<Number> values;
  for (Number s : points) values.push_back(horner(series, s));
  Series slope = differentiate(series);
  std::vector<Root> roots;
  std::vector<size_t> touches;
  size_t before = 0;
  for (size_t i = 1; i < points.size(); i++) {
    if (i + 1 < points.size() && fabsq(values[i]) <= tolerance) {
      touches.push_back(i);
      continue;
    }
    bool changes = (values[before] > 0) != (values[i] > 0);
    if (!touches.empty()) {
      size_t nearest = *std::min_element(touches.begin(), touches.end(), [&](size_t a, size_t b) {
        return fabsq(values[a]) < fabsq(values[b]);
      });
      roots.push_back({points[nearest], changes ? CONTACT : GRAZE});
    } else if (changes) {
      roots.push_back({polish(series, slope, points[before], points[i], values[before] > 0), CONTACT});
    }
    before = i;
    touches.clear();
  }
  return roots;
}

// A multiple root is known to all digits from the highest derivative that has it as a simple one.
Number multiple(const Series& series, Number s, Number tolerance) {
  std::vector<Series> lower{series};
  Number best = s;
  while (lower.size() <= 4 && fabsq(horner(differentiate(lower.back()), best)) < 1e-4Q) {
    Series top = differentiate(lower.back()), slope = differentiate(top);
    Number place = best;
    for (int i = 0; i < 8; i++) {
      Number steepness = horner(slope, place);
      if (steepness != 0) place -= horner(top, place) / steepness;
    }
    bool all = true;
    Number allowed = tolerance;
    for (const Series& row : lower) {
      all = all && fabsq(horner(row, place)) <= allowed;
      allowed *= 32;
    }
    if (all) best = place;
    lower.push_back(top);
  }
  return best;
}

Root first_root(const Series& series, Number tolerance, int depth = 0) {
  std::vector<Series> derivatives{series};
  while (true) {
    const Series& top = derivatives.back();
    Number rest = 0;
    for (size_t n = 1; n < top.size(); n++) rest += fabsq(top[n]);
    if (fabsq(top[0]) > rest || (rest == 0 && top[0] == 0)) break;
    if (derivatives.size() > size_t(MAX_DERIVATIVE)) {
      if (depth > 100) throw std::string("the roots of a step cannot be isolated");
      Series left = series;
      Number half = 1;
      for (Number& coefficient : left) coefficient *= half, half /= 2;
      Root found = first_root(left, tolerance, depth + 1);
      if (found.kind != NONE) return {found.s / 2, found.kind};
      for (size_t i = 0; i + 1 < left.size(); i++)
        for (size_t j = left.size() - 1; j-- > i;) left[j] += left[j + 1];
      found = first_root(left, tolerance, depth + 1);
      return {(found.s + 1) / 2, found.kind};
    }
    derivatives.push_back(differentiate(top));
  }
  if (derivatives.size() == 1) return {0, NONE};
  std::vector<Number> cuts;
  for (size_t n = derivatives.size() - 1; n-- > 1;) {
    std::vector<Root> roots = monotone_roots(derivatives[n], cuts, -1);
    cuts.clear();
    for (const Root& root : roots) cuts.push_back(root.s);
  }
  for (const Root& root : monotone_roots(series, cuts, tolerance))
    if (root.s > 0 && root.s <= 1) return {multiple(series, root.s, tolerance), root.kind};
  return {0, NONE};
}

std::string text(Number value) {
  char buffer[64];
  quadmath_snprintf(buffer, sizeof buffer, "%.36Qg", value);
  return buffer;
}

struct Motion {
  Number cm, w0sq, f0, Om, A[4], belt[3], t = 0, x, v, C, S, end, h, tolerance;
  int contact = 0;  // the boundary that the mass is on and leaves, or 0

  void prepare() {
    double fast = double(cm) + std::sqrt(double(w0sq)) + double(Om);
    h = exp2q(floorq(log2q(REACH / fast)));
    Number largest = std::max({fabsq(A[1]), fabsq(A[2]), fabsq(A[3])});
    tolerance = RELATIVE * (1 + fabsq(f0) + largest + std::max(cm, Number(1)) * std::max(fabsq(belt[1]), fabsq(belt[2])));
    for (int b : {2, 1})
      if (v == belt[b]) contact = b;
  }

  // F and its G-functions at the present state, 0 where they vanish.
  Series derivatives(int alpha) const {
    Number drive[2] = {f0 * C, -f0 * S}, size = tolerance, power = 1, rate = std::max(Number(1), floorq(cm + Om + 1));
    Series values{v, A[alpha] + drive[0] - w0sq * x - cm * v};
    if (fabsq(values[1]) <= size) values[1] = 0;
    for (int n = 1; n < MAX_G; n++) {
      power *= Om;
      size *= rate;
      Number value = drive[n % 2] * (n % 4 < 2 ? 1 : -1) * power - cm * values[n] - w0sq * values[n - 1];
      values.push_back(fabsq(value) <= size ? Number(0) : value);
    }
    values.erase(values.begin());
    return values;
  }

  int effective(int alpha) const {
    for (Number value : derivatives(alpha))
      if (value != 0) return value > 0 ? 1 : -1;
    return 0;
  }

  std::string resolve(int boundary) {
    v = belt[boundary];
    int low = effective(boundary), high = effective(boundary + 1);
    if (low > 0 && high > 0) return "Omega" + std::to_string(boundary + 1);
    if (low < 0 && high < 0) return "Omega" + std::to_string(boundary);
    return "belt" + std::to_string(boundary);
  }

  std::pair<Kind, int> fly(int alpha) {
    Series xs{x}, vs{v}, Cs{C}, Ss{S};
    for (int n = 0; n < ORDER; n++) {
      Number force = f0 * Cs[n] - w0sq * xs[n] - cm * vs[n] + (n ? Number(0) : A[alpha]), step = h / (n + 1);
      xs.push_back(step * vs[n]);
      vs.push_back(step * force);
      Number c = -step * Om * Ss[n], s = step * Om * Cs[n];
      Cs.push_back(c);
      Ss.push_back(s);
    }
    Root best{2, NONE};
    int where = 0;
    for (int boundary : {1, 2}) {
      if (boundary != alpha - 1 && boundary != alpha) continue;
      Series gap = vs;
      gap[0] -= belt[boundary];
      if (boundary == contact) {  // divide the root at the start out
        Series values = derivatives(alpha);
        size_t zeros = 0;
        while (zeros < values.size() && values[zeros] == 0) zeros++;
        if (zeros == values.size()) throw std::string("a flight that stays on its belt");
        gap.erase(gap.begin(), gap.begin() + 1 + long(zeros));
      }
      Root root = first_root(gap, tolerance);
      if (root.kind != NONE && root.s < best.s) best = root, where = boundary;
    }
    return move(xs, vs, Cs, Ss, best, where);
  }

  std::pair<Kind, int> slide(int boundary) {
    Series xs{x, belt[boundary] * h}, Cs{C}, Ss{S};
    for (int n = 0; n < ORDER; n++) {
      Number step = h / (n + 1), c = -step * Om * Ss[n], s = step * Om * Cs[n];
      Cs.push_back(c);
      Ss.push_back(s);
    }
    Root best{2, NONE};
    for (int alpha : {boundary, boundary + 1}) {
      Series force;
      for (Number c : Cs) force.push_back(f0 * c);
      force[0] += A[alpha] - cm * belt[boundary] - w0sq * x;
      force[1] -= w0sq * xs[1];
      while (contact && !force.empty() && fabsq(force[0]) <= tolerance) force.erase(force.begin());
      if (force.empty()) continue;
      Root root = first_root(force, tolerance);
      if (root.kind != NONE && root.s < best.s) best = root;
    }
    return move(xs, {belt[boundary]}, Cs, Ss, best, boundary);
  }

  std::pair<Kind, int> move(const Series& xs, const Series& vs, const Series& Cs, const Series& Ss, Root best, int where) {
    Number last = (end - t) / h, s = best.kind != NONE ? best.s : Number(1);
    Kind found = s <= last ? best.kind : NONE;
    bool ends = s >= last;
    s = std::min(s, last);
    x = horner(xs, s), v = horner(vs, s), C = horner(Cs, s), S = horner(Ss, s);
    t = ends ? end : t + s * h;
    contact = 0;
    return {found, where};
  }

  void run(int most) {
    std::string mode = contact ? resolve(contact) : "Omega" + std::to_string(1 + (v > belt[1]) + (v > belt[2]));
    int events = 0;
    while (t < end && events < most) {
      std::string source = mode;
      bool stuck = mode[0] == 'b';
      int place = mode.back() - '0';
      auto [kind, boundary] = stuck ? slide(place) : fly(place);
      if (kind == NONE) continue;
      contact = boundary;
      if (kind != GRAZE) mode = resolve(boundary);
      bool graze = kind == GRAZE || mode == source;
      if (graze && stuck) continue;
      const char* name = graze ? "graze" : stuck ? "slip" : mode[0] == 'b' ? "stick" : "cross";
      std::cout << "event " << text(t) << ' ' << text(x) << ' ' << name << ' ' << boundary << ' ' << source << ' ' << mode << '\n';
      events++;
    }
    std::cout << "end " << mode << ' ' << text(t) << ' ' << text(x) << ' ' << text(v) << std::endl;
  }
};

int main() {
  std::string line, word;
  while (std::getline(std::cin, line)) {
    std::istringstream words(line);
    auto next = [&] { return words >> word, strtoflt128(word.c_str(), nullptr); };
    Motion motion;
    motion.cm = next(), motion.w0sq = next(), motion.f0 = next(), motion.Om = next();
    for (int alpha : {1, 2, 3}) motion.A[alpha] = next();
    motion.belt[1] = next(), motion.belt[2] = next();
    motion.x = next(), motion.v = next(), motion.C = next(), motion.S = next(), motion.end = next();
    int most = int(next());
    motion.prepare();
    try {
      motion.run(most);
    } catch (const std::string& reason) {
      std::cout << "error " << reason << std::endl;
    }
  }
}
