// A second checker of certificates of trajectories and orbits, for the tests. It shares nothing with verify.py: other
// mathematics (Taylor steps of the differential equation with Picard's a priori bounds, Krawczyk's operator), other
// numbers (fixed-point intervals over GMP's integers) and another language.
//
// Input, as words on stdin (numbers are decimals n or fractions n/d):
//   bits kind m c k A0 B0 Omega FN, number of belts, belts: v slope mu_s, number of points, points: w mu
//   trajectory: t0 x0 v0, three errors, t_end, free (0, 1, 2 or -1), low, high, initial mode, number of events, events
//   orbit: periods, half-widths of t and x, four numbers for each of two multipliers, stable (1, 0, -1), number, events
//   an event: kind boundary source target t_low t_high x_low x_high reach; modes of n belts are 1 to n + 1 (domains),
//   n + 2 to 2n + 1 (belts). A passage of a corner of a friction curve is an event too, of the kind "corner".
// Output: "proven", or why not. Exit code 0, 1 (not proven) or 3 (more bits may help).
//
// The state is y = (x, v, C, S) with C = cos(Omega t), S = sin(Omega t), and columns (dx, dv): its derivatives at a
// fixed time by t, x and v at the start of the mode. Edges are the speeds of belts and corners; in every band between two
//   x' = v, v' = a = (A + B0 C - k x - c v)/m, C' = -Omega S, S' = Omega C;  dx' = dv, dv' = -(k dx + c dv)/m,
// with the A and the c of the band, and on a belt v' = 0, dv' = 0. Everything that ends a mode is linear in (1, x, v, C, S).
// Inside the program modes are 1 to N (bands), N + l (the stick on edge l).
#include <gmpxx.h>

#include <array>
#include <cmath>
#include <iostream>
#include <map>
#include <string>
#include <vector>

using Z = mpz_class;
struct Refuse { int code; std::string why; };
[[noreturn]] void refuse(const std::string& why) { throw Refuse{1, why}; }
[[noreturn]] void undecided(const std::string& why) { throw Refuse{3, why}; }

// ---- intervals of fixed-point numbers, unit 2^-bits, rounded outward
unsigned bits;
struct I { Z lo, hi; };
Z down(const Z& a, unsigned by) { Z r; mpz_fdiv_q_2exp(r.get_mpz_t(), a.get_mpz_t(), by); return r; }
Z up(const Z& a, unsigned by) { Z r; mpz_cdiv_q_2exp(r.get_mpz_t(), a.get_mpz_t(), by); return r; }
Z floor_div(const Z& a, const Z& b) { Z r; mpz_fdiv_q(r.get_mpz_t(), a.get_mpz_t(), b.get_mpz_t()); return r; }
Z ceil_div(const Z& a, const Z& b) { Z r; mpz_cdiv_q(r.get_mpz_t(), a.get_mpz_t(), b.get_mpz_t()); return r; }
I thin(const Z& a) { return {a, a}; }
I integer(long n) { return thin(Z(n) << bits); }
I operator+(const I& a, const I& b) { return {a.lo + b.lo, a.hi + b.hi}; }
I operator-(const I& a, const I& b) { return {a.lo - b.hi, a.hi - b.lo}; }
I operator-(const I& a) { return {-a.hi, -a.lo}; }
I operator*(const I& a, const I& b) {
    Z p = a.lo * b.lo, q = a.lo * b.hi, r = a.hi * b.lo, s = a.hi * b.hi;
    return {down(std::min(std::min(p, q), std::min(r, s)), bits), up(std::max(std::max(p, q), std::max(r, s)), bits)};
}
I over(const I& a, long n) { return {floor_div(a.lo, n), ceil_div(a.hi, n)}; }
bool positive(const I& a) { return a.lo > 0; }
bool negative(const I& a) { return a.hi < 0; }
I operator/(const I& a, const I& b) {
    if (negative(b)) return -a / -b;
    if (!positive(b)) undecided("a quotient by 0");
    Z l = a.lo << bits, h = a.hi << bits;
    return {std::min(floor_div(l, b.lo), floor_div(l, b.hi)), std::max(ceil_div(h, b.lo), ceil_div(h, b.hi))};
}
I hull(const I& a, const I& b) { return {std::min(a.lo, b.lo), std::max(a.hi, b.hi)}; }
I meet(const I& a, const I& b) {
    I both{std::max(a.lo, b.lo), std::min(a.hi, b.hi)};
    if (both.lo > both.hi) refuse("an empty enclosure");
    return both;
}
bool within(const I& a, const I& b) { return b.lo < a.lo && a.hi < b.hi; }
Z middle(const I& a) { return down(a.lo + a.hi, 1); }
I plus_minus(const I& a) { Z most = std::max(abs(a.lo), abs(a.hi)); return {-most, most}; }
I exact(const mpq_class& q) {
    Z n = q.get_num() << bits;
    return {floor_div(n, q.get_den()), ceil_div(n, q.get_den())};
}
mpq_class word() {
    std::string text;
    if (!(std::cin >> text)) refuse("input that ends early");
    mpq_class q(text, 10);
    q.canonicalize();
    return q;
}
I read() { return exact(word()); }
int whole() { return static_cast<int>(word().get_num().get_si()); }

// ---- the oscillator, divided by its mass
I k, B, Om, zero, one, pi;
struct Edge { I speed, excess; int belt; };  // excess of static friction, as an acceleration; belt 0: a corner
struct Band { I c, force; int domain; };
std::vector<Edge> edges(1);
std::vector<Band> bands(1);
std::vector<int> at_belts, at_corners;  // their edges
int N;
long step_exponent;  // steps take 2^-step_exponent
struct Belt { mpq_class v, slope, mu_s; std::vector<std::pair<mpq_class, mpq_class>> curve; };
// Line of a belt's friction where the relative speed is about w: its value at 0, and its slope.
std::pair<mpq_class, mpq_class> line(const Belt& belt, const mpq_class& w) {
    size_t n = belt.curve.size() - 1;
    while (belt.curve[n].first > w) n--;
    const auto& [from, mu] = belt.curve[n];
    mpq_class slope = belt.slope;
    if (n + 1 < belt.curve.size()) slope = (belt.curve[n + 1].second - mu) / (belt.curve[n + 1].first - from);
    return {mu - slope * from, slope};
}
int name(int mode) {  // as files number modes
    return mode <= N ? bands[mode].domain : static_cast<int>(at_belts.size()) + 1 + edges[mode - N].belt;
}

void read_oscillator() {
    mpq_class m = word(), damping = word(), spring = word(), A0 = word(), B0 = word(), omega = word();
    mpq_class FN = word();
    if (m <= 0 || omega <= 0 || damping < 0 || spring < 0 || FN < 0) refuse("parameters out of range");
    k = exact(spring / m), B = exact(B0 / m), Om = exact(omega), zero = integer(0), one = integer(1);
    std::vector<Belt> belts(whole());
    std::map<mpq_class, int> places;  // of edges, with the number of the belt
    for (size_t n = 0; n < belts.size(); n++) {
        Belt& belt = belts[n];
        belt.v = word(), belt.slope = word(), belt.mu_s = word();
        belt.curve.resize(whole());
        for (auto& [w, mu] : belt.curve) w = word(), mu = word();
        bool right = !belt.curve.empty() && belt.curve[0].first == 0 && belt.slope >= 0 && belt.mu_s >= belt.curve[0].second;
        for (size_t i = 0; right && i < belt.curve.size(); i++)
            right = belt.curve[i].second >= 0 && (i == 0 || belt.curve[i].first > belt.curve[i - 1].first);
        if (!right || (n > 0 && belts[n - 1].v >= belt.v)) refuse("a belt out of range");
    }
    for (const Belt& belt : belts)
        for (const auto& [w, mu] : belt.curve) places[belt.v - w] = places[belt.v + w] = 0;
    for (size_t n = 0; n < belts.size(); n++) places[belts[n].v] = static_cast<int>(n) + 1;
    std::vector<std::pair<mpq_class, int>> all(places.begin(), places.end());
    mpq_class c_before, A_before, fastest = 0;
    for (size_t i = 0; i <= all.size(); i++) {  // the band above all[i - 1] and below all[i]
        mpq_class inside = (all[i > 0 ? i - 1 : 0].first + all[i < all.size() ? i : i - 1].first) / 2;
        if (i == 0) inside -= 1;
        if (i == all.size()) inside += 1;
        mpq_class c_here = damping, A_here = A0;
        int domain = 1;
        for (const Belt& belt : belts) {
            int drags = inside < belt.v ? 1 : -1;
            domain += drags < 0;
            auto [mu, slope] = line(belt, drags * (belt.v - inside));
            c_here += FN * slope, A_here += FN * (drags * mu + slope * belt.v);
        }
        if (i > 0) {
            int belt = all[i - 1].second;
            if (!belt && c_here == c_before && A_here == A_before) continue;  // no corner
            mpq_class excess = 0;
            if (belt) excess = (belts[belt - 1].mu_s - belts[belt - 1].curve[0].second) * FN / m;
            (belt ? at_belts : at_corners).push_back(static_cast<int>(edges.size()));
            edges.push_back({exact(all[i - 1].first), exact(excess), belt});
        }
        bands.push_back({exact(c_here / m), exact(A_here / m), domain});
        c_before = c_here, A_before = A_here;
        mpq_class damps = abs(c_here) / m;
        if (damps > fastest) fastest = damps;
    }
    N = static_cast<int>(bands.size()) - 1;
    double rate = fastest.get_d() + std::sqrt(mpq_class(spring / m).get_d()) + omega.get_d();
    for (step_exponent = -20; rate * std::pow(2.0, -static_cast<double>(step_exponent)) > 0.5;) step_exponent++;
    auto arctangent = [](long n) {  // of 1/n, by its alternating series
        I sum = zero, term = over(one, n);
        for (long j = 1; term.hi > 1; j += 2, term = over(term, n * n))
            sum = j % 4 == 1 ? sum + over(term, j) : sum - over(term, j);
        return sum + I{-2, 2};
    };
    pi = integer(16) * arctangent(5) - integer(4) * arctangent(239);
}

// ---- Taylor's polynomial of a motion about a time, with a remainder that holds for a range of times around it
using Row = std::array<I, 5>;  // factors of 1, x, v, C, S
struct State { std::array<I, 4> y; std::vector<std::array<I, 2>> columns; };
using Series = std::vector<I>;

struct Polynomial {
    std::array<Series, 4> y;
    std::vector<std::array<Series, 2>> columns;
};
I at(const Series& p, const I& t) {
    I sum = p.back();
    for (size_t n = p.size() - 1; n-- > 0;) sum = sum * t + p[n];
    return sum;
}
State derivative(int mode, const State& s) {
    const auto& [x, v, C, S] = s.y;
    bool flies = mode <= N;
    const I& c = bands[flies ? mode : 1].c;
    State d{{v, flies ? bands[mode].force + B * C - k * x - c * v : zero, -(Om * S), Om * C}, {}};
    for (const auto& [dx, dv] : s.columns) d.columns.push_back({dv, flies ? -(k * dx) - c * dv : zero});
    return d;
}
Polynomial coefficients(int mode, const State& s, size_t order) {
    Polynomial p;
    for (int i = 0; i < 4; i++) p.y[i] = {s.y[i]};
    for (const auto& each : s.columns) p.columns.push_back({Series{each[0]}, Series{each[1]}});
    for (size_t n = 0; n < order; n++) {
        State now;
        for (int i = 0; i < 4; i++) now.y[i] = p.y[i][n];
        for (const auto& each : p.columns) now.columns.push_back({each[0][n], each[1][n]});
        State next = derivative(mode, now);
        if (n > 0 && mode <= N) next.y[1] = next.y[1] - bands[mode].force;  // a constant has no further coefficient
        for (int i = 0; i < 4; i++) p.y[i].push_back(over(next.y[i], n + 1));
        for (size_t j = 0; j < p.columns.size(); j++)
            for (int i = 0; i < 2; i++) p.columns[j][i].push_back(over(next.columns[j][i], n + 1));
    }
    return p;
}
// Picard: if start + range f(W) lies in W, the motion stays in W for all times of the range.
State a_priori(int mode, const State& start, const I& range) {
    State W = start;
    for (int tries = 0; tries < 200; tries++) {
        State d = derivative(mode, W);
        bool holds = true;
        auto widen = [&](I& w, const I& from, const I& rate) {
            I next = from + range * rate;
            if (w.lo <= next.lo && next.hi <= w.hi) return;
            holds = false;
            I both = hull(w, next);
            Z spare = down(both.hi - both.lo, 3) + 4;
            w = {both.lo - spare, both.hi + spare};
        };
        for (int i = 0; i < 4; i++) widen(W.y[i], start.y[i], d.y[i]);
        for (size_t j = 0; j < W.columns.size(); j++)
            for (int i = 0; i < 2; i++) widen(W.columns[j][i], start.columns[j][i], d.columns[j][i]);
        if (holds) return W;
    }
    undecided("no a priori bound");
}
Polynomial motion(int mode, const State& start, const I& range) {
    size_t order = 4;
    for (double size = 0; size < bits + 20; order++) size += 1 + std::log2(static_cast<double>(order));
    Polynomial p = coefficients(mode, start, order), rest = coefficients(mode, a_priori(mode, start, range), order);
    for (int i = 0; i < 4; i++) p.y[i][order] = rest.y[i][order];
    for (size_t j = 0; j < p.columns.size(); j++)
        for (int i = 0; i < 2; i++) p.columns[j][i][order] = rest.columns[j][i][order];
    return p;
}
State at(const Polynomial& p, const I& t) {
    State s;
    for (int i = 0; i < 4; i++) s.y[i] = at(p.y[i], t);
    for (const auto& each : p.columns) s.columns.push_back({at(each[0], t), at(each[1], t)});
    return s;
}
Series times(const Row& row, const Polynomial& p) {
    Series sum;
    for (size_t n = 0; n < p.y[0].size(); n++) {
        I each = n ? zero : row[0];
        for (int i = 0; i < 4; i++) each = each + row[i + 1] * p.y[i][n];
        sum.push_back(each);
    }
    return sum;
}
I times(const Row& row, const State& s) {
    I sum = row[0];
    for (int i = 0; i < 4; i++) sum = sum + row[i + 1] * s.y[i];
    return sum;
}

// ---- what ends a mode: rows of a function that is > 0 while the mode lasts, of its first and its second derivative
struct Guard { int edge, target; Row rows[3]; };  // a flight's edge; or the band that a stick ends in
Row scaled(const Row& row, int sign) {
    Row r = row;
    if (sign < 0) for (I& each : r) each = -each;
    return r;
}
Row acceleration(int band) { return {bands[band].force, -k, -bands[band].c, B, zero}; }
std::vector<Guard> guards(int mode) {
    std::vector<Guard> all;
    if (mode <= N) {
        const I& c = bands[mode].c;
        Row a = acceleration(mode), jerk = {-(c * a[0]), -(c * a[1]), -k - c * a[2], -(c * a[3]), -(B * Om)};
        for (auto [edge, sign] : {std::pair{mode - 1, 1}, std::pair{mode, -1}})
            if (edge > 0 && edge < N)
                all.push_back({edge, 0, {scaled({-edges[edge].speed, zero, one, zero, zero}, sign), scaled(a, sign), scaled(jerk, sign)}});
    } else {
        int edge = mode - N;
        const I& speed = edges[edge].speed;
        for (auto [band, sign] : {std::pair{edge, 1}, std::pair{edge + 1, -1}}) {
            Row a = acceleration(band);
            a[0] = a[0] + a[2] * speed + (sign > 0 ? edges[edge].excess : -edges[edge].excess), a[2] = zero;
            Row slope = {-(k * speed), zero, zero, zero, -(B * Om)}, bend = {zero, zero, zero, -(B * Om * Om), zero};
            all.push_back({edge, band, {scaled(a, sign), scaled(slope, sign), scaled(bend, sign)}});
        }
    }
    return all;
}

// ---- a motion in one mode from a time in `begin` on; `state` belongs to the time `base`, the lower end of it
// A set of them knows more: the state of its centre at `base`, and the derivatives of t, x, v at the start by s.
using Columns = std::vector<std::array<I, 3>>;
struct Phase { int mode; I begin; Z base; State state; std::vector<int> leaves; State centre{}; Columns spread{}; };
// leaves[edge]: the order of the first derivative that is not 0 at the start, 0 if the distance is not 0

// A state of a set lies within the centre's + columns s, s in [-1, 1] (mean value theorem).
void narrow(State& state, const State& centre, const Columns& spread) {
    for (int i = 0; i < 2 && !spread.empty(); i++) {
        I value = centre.y[i];
        for (const auto& each : spread) {
            I moved = zero;
            for (int j = 0; j < 3; j++) moved = moved + state.columns[j][i] * each[j];
            value = value + plus_minus(moved);
        }
        state.y[i] = meet(state.y[i], value);
    }
}
struct Event { std::string kind; int edge, source, target; I t, x, reach; };

long budget = 20000;
// Prove that f > 0 from a to b (of which f' is given).
void stays_positive(const Series& f, const Series& slope, const Z& a, const Z& b, int depth = 0) {
    if (--budget < 0) undecided("a budget of steps that is used up");
    I range{a, b};
    if (positive(at(f, range))) return;
    I first = at(f, thin(a)), last = at(f, thin(b)), d = at(slope, range);
    if (negative(first) || negative(last)) refuse("a mode that ends before the event stated");
    if (positive(first) && positive(last) && (positive(d) || negative(d))) return;
    if (depth > 400 || b - a < 2) undecided("a near miss");
    Z half = down(a + b, 1);
    stays_positive(f, slope, a, half, depth + 1);
    stays_positive(f, slope, half, b, depth + 1);
}
struct Reached { Z base; State state; Polynomial p; };  // the motion from `base` on, up to `until` and a little more
Reached follow(Phase phase, const Z& until, const Z& beyond, bool prove) {
    auto all = guards(phase.mode);
    Z h = Z(1) << (bits - step_exponent), base = phase.base;
    if (until < phase.begin.lo) refuse("an event that is not after the one before it");
    if (until <= phase.begin.hi) undecided("an event that is not after the one before it");
    State state = phase.state, centre = phase.centre;
    auto advance = [&](const Polynomial& p, const Z& by) {
        state = at(p, thin(by)), base += by;
        if (phase.spread.empty()) return;
        centre = at(motion(phase.mode, centre, {0, by}), thin(by));
        narrow(state, centre, phase.spread);
    };
    bool leaving = false;
    for (const Guard& guard : all) leaving = leaving || (phase.mode <= N && phase.leaves[guard.edge]);
    while (true) {
        if ((budget -= 10) < 0) undecided("a budget of steps that is used up");
        bool last = until - base <= h;
        Z far = last ? beyond - base : h, near = last ? until - base : h;
        Polynomial p = motion(phase.mode, state, {0, far});
        if (leaving && prove) {  // what is 0 at the start has a derivative > 0 for a while
            Z first = near;
            for (const Guard& guard : all) {
                int order = phase.leaves[guard.edge];
                if (!order) continue;
                while (!positive(at(times(guard.rows[order], p), {0, first}))) {
                    first = down(first, 1);
                    if (base + first <= phase.begin.hi) undecided("how a mode begins");
                }
            }
            for (const Guard& guard : all)
                if (!phase.leaves[guard.edge]) stays_positive(times(guard.rows[0], p), times(guard.rows[1], p), 0, first);
            leaving = false;
            if (first < near) {
                advance(p, first);
                continue;
            }
        } else if (prove) {
            for (const Guard& guard : all) stays_positive(times(guard.rows[0], p), times(guard.rows[1], p), 0, near);
        }
        if (last) return {base, state, p};
        advance(p, h);
    }
}
// Return the zero of f in a range (interval Newton); f' excludes 0.
I root(const Series& f, const Series& slope, I range) {
    for (int tries = 0; tries < 100; tries++) {
        Z m = middle(range), before = range.hi - range.lo;
        range = meet(range, thin(m) - at(f, thin(m)) / at(slope, range));
        if (range.hi - range.lo > down(before * 3, 2)) break;
    }
    return range;
}
// Return a phase that begins at `when` with x and v; C and S belong to `when`, the other two to its lower end.
Phase enter(int mode, const I& when, const I& x, const I& v, const I& C, const I& S, const I& C_base, const I& S_base, bool from_slip = false) {
    State s{{x, v, C, S}, {}};
    State d = derivative(mode, s);
    s.columns = {{-v, mode > N || from_slip ? zero : -d.y[1]}, {one, zero}, {zero, one}};
    I back{when.lo - when.hi, 0};
    State then = at(motion(mode, s, back), back);
    then.y[2] = C_base, then.y[3] = S_base;
    return {mode, when, when.lo, then, std::vector<int>(edges.size())};
}
void clock(const I& t, I& C, I& S) {  // cos and sin of Omega t, by halving and doubling the angle
    long halvings = step_exponent + 2;
    for (Z size = std::max(abs(t.lo), abs(t.hi)) >> bits; size > 0; size >>= 1) halvings++;
    halvings = std::max(halvings, 0L);
    I part{down(t.lo, halvings), up(t.hi, halvings)};
    State s = at(motion(N + 1, {{zero, zero, one, zero}, {}}, hull(part, zero)), part);
    C = s.y[2], S = s.y[3];
    for (long i = 0; i < halvings; i++) {
        I twice = integer(2) * C;
        S = twice * S, C = twice * C - one;
    }
}
Phase start(const I& t, const I& x, const I& v, int mode) {
    I C, S, C_base, S_base;
    clock(t, C, S), clock(thin(t.lo), C_base, S_base);
    return enter(mode, t, x, v, C, S, C_base, S_base);
}
struct Passed { Z low, high; I t, x; std::array<std::array<I, 2>, 3> columns; int target; Reached seen; int order; };

// Prove that the next event is the one stated (a crossing, a stick or a slip). Of some of the starts for which that is
// `proven`, only find where it is.
Passed pass(const Phase& phase, const Event& e, const Passed* proven = nullptr) {
    bool flies = phase.mode <= N;
    if (e.source != name(phase.mode)) refuse("an event of another mode");
    auto all = guards(phase.mode);
    const Guard* ended = nullptr;
    for (const Guard& guard : all)
        if (flies ? guard.edge == e.edge : name(guard.target) == e.target) ended = &guard;
    if (!ended || ended->edge != e.edge) refuse("an event at a belt where the motion is not");
    Z w = e.t.hi - e.t.lo + e.reach.hi, low, high;
    Reached seen;
    Series f, slope;
    I range;
    for (int factor = 4;; factor *= 8) {  // a wide set of starts needs more room for a change of sign
        low = proven ? proven->low : Z(e.t.lo - factor * w), high = proven ? proven->high : Z(e.t.hi + factor * w);
        seen = follow(phase, low, high, false);
        range = {low - seen.base, high - seen.base};
        f = times(ended->rows[0], seen.p), slope = times(ended->rows[1], seen.p);
        bool changes = positive(at(f, thin(range.lo))) && negative(at(f, thin(range.hi))) && negative(at(slope, range));
        if (changes) break;
        if (proven || factor > 1 << 24) undecided("a change of sign at the event stated");
    }
    if (!proven) {
        follow(phase, low, high, true);
        for (const Guard& guard : all)
            if (&guard != ended && !positive(at(times(guard.rows[0], seen.p), range))) undecided("another event beside the one stated");
    }
    I when = root(f, slope, range);
    State s = at(seen.p, when);
    int target = ended->target;
    if (flies) {
        bool up = phase.mode == e.edge;
        int other = up ? e.edge + 1 : e.edge;  // the band beyond the edge
        I after = times(acceleration(other), s), spare = (up ? after : -after) - edges[e.edge].excess;
        if (!(positive(spare) || negative(spare))) undecided("the force beyond the belt");
        target = positive(spare) ? other : N + e.edge;
    }
    std::string kind = !flies ? "slip" : target > N ? "stick" : edges[e.edge].belt ? "cross" : "corner";
    if (kind != e.kind || name(target) != e.target) refuse("an event of another kind");
    Z m = middle(when);
    I x = meet(s.y[0], at(seen.p.y[0], thin(m)) + s.y[1] * (when - thin(m)));
    I rate = times(ended->rows[1], s);
    std::array<std::array<I, 2>, 3> columns;  // of (t, x) by t, x and v at the start of the mode
    for (int i = 0; i < 3; i++) {
        const auto& [dx, dv] = s.columns[i];
        I dt = -(ended->rows[0][1] * dx + ended->rows[0][2] * dv) / rate;
        columns[i] = {dt, dx + edges[e.edge].speed * dt};
    }
    bool jumps = positive(edges[e.edge].excess);  // a slip begins with a force
    return {low, high, when + thin(seen.base), x, columns, target, seen, flies || jumps ? 1 : 2};
}
// Enter the mode behind an event, from enclosures of its time and position.
Phase behind(const Passed& passed, int edge, const I& t, const I& x) {
    const Reached& seen = passed.seen;
    State there = at(seen.p, t - thin(seen.base)), base = at(seen.p, thin(t.lo - seen.base));
    Phase next = enter(passed.target, t, x, edges[edge].speed, there.y[2], there.y[3], base.y[2], base.y[3], passed.order == 2);
    if (passed.target <= N) next.leaves[edge] = passed.order;
    return next;
}
void inside(const I& value, const I& stated, const char* what) {
    if (value.hi < stated.lo || value.lo > stated.hi) refuse(what);
    if (!within(value, stated)) undecided(what);
}

// A set of starts: a wide phase, and a thin one from its centre. `columns` has the derivatives of (t, x, v) at the start
// of the mode by parameters s in [-1, 1], so that t, x, v are those of the centre + columns s (mean value theorem).
struct Set {
    Phase wide, centre;
    Columns columns;
    Set(const Phase& all, const Phase& middle, const Columns& by) : wide(all), centre(middle), columns(by) {
        if (columns.empty()) return;
        I back = thin(wide.base - centre.base);
        wide.centre = at(motion(wide.mode, centre.state, hull(back, zero)), back), wide.spread = columns;
        narrow(wide.state, wide.centre, columns);
    }
};
Set step(const Set& set, const Event& e, I* t, I* x, Passed* passed) {
    *passed = pass(set.wide, e);
    *t = passed->t, *x = passed->x;
    if (set.columns.empty()) {
        Phase next = behind(*passed, e.edge, *t, *x);
        return Set(next, next, {});
    }
    Columns columns;
    for (const auto& each : set.columns) {
        std::array<I, 3> sum{zero, zero, zero};
        for (int i = 0; i < 3; i++)
            for (int j = 0; j < 2; j++) sum[j] = sum[j] + passed->columns[i][j] * each[i];
        columns.push_back(sum);
    }
    Passed thinner = pass(set.centre, e, passed);
    I all_t = thinner.t, all_x = thinner.x;
    for (const auto& each : columns) all_t = all_t + plus_minus(each[0]), all_x = all_x + plus_minus(each[1]);
    *t = meet(*t, all_t), *x = meet(*x, all_x);
    Set next(behind(*passed, e.edge, *t, *x), behind(thinner, e.edge, thinner.t, thinner.x), columns);
    passed->t = thinner.t, passed->x = thinner.x;  // of the centre
    return next;
}
std::vector<Event> read_events() {
    std::vector<Event> events(whole());
    for (Event& e : events) {
        std::cin >> e.kind;
        const auto& known = e.kind == "corner" ? at_corners : at_belts;
        int boundary = whole();
        if (boundary < 1 || boundary > static_cast<int>(known.size())) refuse("an event at no belt");
        e.edge = known[boundary - 1], e.source = whole(), e.target = whole();
        I t_low = read(), t_high = read(), x_low = read(), x_high = read();
        e.t = {t_low.lo, t_high.hi}, e.x = {x_low.lo, x_high.hi}, e.reach = read();
        if (e.t.lo >= e.t.hi || e.x.lo >= e.x.hi || e.reach.lo < 0) refuse("an event out of range");
    }
    return events;
}

// A graze: of the starts between two ends just one touches (the least distance has different signs at the ends, and its
// derivative by the start is not 0). Return the phase behind the touch, with all starts.
Phase touch(const Set& set, const std::vector<Phase>& limits, const Event& e, I* t, I* x) {
    const Phase& wide = set.wide;
    if (positive(edges[e.edge].excess)) refuse("a graze of a belt that holds what touches it");
    if (wide.mode > N || e.source != name(wide.mode) || e.target != e.source) refuse("a graze of another mode");
    Z w = e.t.hi - e.t.lo, low = e.t.lo - 4 * w, high = e.t.hi + 4 * w;
    Reached seen = follow(wide, low, high, true);
    I range{low - seen.base, high - seen.base}, when;
    bool found = false;
    auto all = guards(wide.mode);
    for (const Guard& guard : all) {
        Series f = times(guard.rows[0], seen.p), slope = times(guard.rows[1], seen.p), bend = times(guard.rows[2], seen.p);
        if (guard.edge != e.edge) {
            if (!positive(at(f, range))) undecided("another event beside a graze");
            continue;
        }
        found = true;
        if (!negative(at(slope, thin(range.lo))) || !positive(at(slope, thin(range.hi))) || !positive(at(bend, range)) ||
            !positive(at(f, thin(range.lo))) || !positive(at(f, thin(range.hi))))
            undecided("one least distance at a graze");
        when = root(slope, bend, range);
        State s = at(seen.p, range);
        I moved = zero;
        for (int i = 0; i < 3; i++) moved = moved + guard.rows[0][2] * s.columns[i][1] * set.columns.at(0)[i];
        if (!positive(moved) && !negative(moved)) undecided("that only one start touches");
        int signs[2], i = 0;
        for (const Phase& end : limits) {
            Reached own = follow(end, low, high, false);
            Series g = times(guard.rows[0], own.p), dg = times(guard.rows[1], own.p), ddg = times(guard.rows[2], own.p);
            I least = at(g, root(dg, ddg, {low - own.base, high - own.base}));
            if (!positive(least) && !negative(least)) undecided("a start that touches, or one that does not");
            signs[i++] = positive(least);
        }
        if (signs[0] == signs[1]) refuse("no start that touches");
    }
    if (!found) refuse("a graze of a belt that is not beside the domain");
    State s = at(seen.p, when), base = at(seen.p, thin(when.lo));
    *t = when + thin(seen.base), *x = s.y[0];
    Phase next = enter(wide.mode, *t, *x, edges[e.edge].speed, s.y[2], s.y[3], base.y[2], base.y[3], true);
    next.leaves[e.edge] = 2;
    return next;
}

void trajectory() {
    mpq_class begin[3] = {word(), word(), word()}, error[3] = {word(), word(), word()}, end = word();
    int free = whole();
    mpq_class low = word(), high = word();
    int mode = whole();
    std::vector<Event> events = read_events();
    if (free >= 0) {
        if (low >= high || low < begin[free] - error[free] || high > begin[free] + error[free]) refuse("a free number out of range");
        begin[free] = (low + high) / 2;
        for (int i = 0; i < 3; i++) error[i] = i == free ? mpq_class((high - low) / 2) : mpq_class(0);
    }
    if (end <= begin[0] || error[0] < 0 || error[1] < 0 || error[2] < 0) refuse("t_end or errors out of range");
    I v0 = exact(begin[2]), wide_v{v0.lo - exact(error[2]).hi, v0.hi + exact(error[2]).hi};
    int at_belt = 0, found = 1;
    for (int edge = 1; edge < N; edge++) {
        if (positive(wide_v - edges[edge].speed)) found = edge + 1;
        else if (!negative(wide_v - edges[edge].speed)) at_belt = edge;
    }
    if (at_belt && (error[2] != 0 || within(edges[at_belt].speed, wide_v))) undecided("a start near a belt");
    Columns columns;
    for (int i = 0; i < 3; i++) {
        if (error[i] == 0) continue;
        columns.push_back({zero, zero, zero});
        columns.back()[i] = exact(error[i]);
    }
    auto make = [&](const mpq_class* centre, const mpq_class* errors, int in) {
        I value[3];
        for (int i = 0; i < 3; i++) value[i] = exact(centre[i]) + plus_minus(exact(errors[i]));
        return start(value[0], value[1], value[2], in);
    };
    if (at_belt) {
        State s = make(begin, error, N + at_belt).state;
        s.y[1] = edges[at_belt].speed;
        I below = times(acceleration(at_belt), s) + edges[at_belt].excess;
        I above = times(acceleration(at_belt + 1), s) - edges[at_belt].excess;
        if (!(positive(below) || negative(below)) || !(positive(above) || negative(above))) undecided("a force at the start");
        found = positive(below) && negative(above) ? N + at_belt : positive(above) ? at_belt + 1 : at_belt;
    }
    if (mode != name(found)) refuse("another mode at the start");
    mode = found;
    mpq_class none[3] = {0, 0, 0}, ends[2][3] = {{begin[0], begin[1], begin[2]}, {begin[0], begin[1], begin[2]}};
    Set set(make(begin, error, mode), make(begin, none, mode), columns);
    if (at_belt && mode <= N) set.wide.leaves[at_belt] = set.centre.leaves[at_belt] = 1;
    std::vector<Phase> limits;
    if (free >= 0) {
        ends[0][free] = low, ends[1][free] = high;
        for (auto& each : ends) limits.push_back(make(each, none, mode));
        if (at_belt && mode <= N) limits[0].leaves[at_belt] = limits[1].leaves[at_belt] = 1;
    }
    for (const Event& e : events) {
        I t, x;
        Passed passed;
        if (e.kind == "graze") {
            if (limits.empty()) undecided("a graze of exact starts, which this checker does not prove");
            Phase next = touch(set, limits, e, &t, &x);
            set = Set(next, next, {}), limits.clear();
        } else {
            set = step(set, e, &t, &x, &passed);
            for (Phase& each : limits) {
                Passed own = pass(each, e, &passed);
                each = behind(own, e.edge, own.t, own.x);
            }
        }
        inside(t, e.t, "the time of an event"), inside(x, e.x, "the position of an event");
    }
    if (!limits.empty()) refuse("no graze, for some starts");
    I until = exact(end);
    follow(set.wide, until.hi, until.hi, true);
}

void orbit() {
    int periods = whole();
    I half[2] = {read(), read()}, stated[2][4];
    for (auto& each : stated) for (I& number : each) number = read();
    int stable = whole();
    std::vector<Event> events = read_events();
    const Event &e0 = events.at(0), &last = events.back();
    if (events.size() < 2 || e0.kind != last.kind || e0.edge != last.edge || e0.source != last.source ||
        e0.target != last.target || e0.kind == "slip" || e0.kind == "corner" || periods < (B.lo == 0 && B.hi == 0 ? 0 : 1))
        refuse("a last event that is not the first one");
    bool free = periods == 0;  // a cycle without a drive, which may begin at any time
    int first_mode = 0;
    for (int mode : {e0.edge, e0.edge + 1, N + e0.edge})
        if (name(mode) == e0.target) first_mode = mode;
    if (!first_mode) refuse("a first event that leads elsewhere");
    I turn = integer(2 * periods) * pi / Om;
    Z centre[2] = {middle(e0.t), middle(e0.x)}, first[2] = {centre[0], centre[1]};
    Z e[2] = {half[0].hi, half[1].hi}, most[2] = {half[0].lo, half[1].lo};
    bool stuck = false;
    for (int round = 0;; round++) {
        auto make = [&](bool wide) {
            I t = wide ? I{centre[0] - e[0], centre[0] + e[0]} : thin(centre[0]);
            I x = wide ? I{centre[1] - e[1], centre[1] + e[1]} : thin(centre[1]);
            Phase phase = start(t, x, edges[e0.edge].speed, first_mode);
            if (first_mode <= N) phase.leaves[e0.edge] = 1;
            return phase;
        };
        Set set(make(true), make(false), {{thin(e[0]), zero, zero}, {zero, thin(e[1]), zero}});
        std::vector<std::array<I, 2>> centres{{thin(centre[0]), thin(centre[1])}};
        std::vector<Columns> columns{set.columns};
        for (size_t i = 1; i < events.size(); i++) {
            I t, x;
            Passed passed;
            stuck = stuck || events[i].kind == "stick";
            set = step(set, events[i], &t, &x, &passed);
            centres.push_back({passed.t, passed.x}), columns.push_back(set.columns);
        }
        // Krawczyk's operator of P(u) - u, in units of the box: s in [-1, 1]^2, J = diag(1/e) D - 1. The box stated has at
        // most one orbit; a smaller one inside has one.
        I J[2][2], off[2];
        if (free) J[0][0] = -one, J[0][1] = J[1][0] = off[0] = zero;
        for (int i = free; i < 2; i++) {
            off[i] = (centres.back()[i] - thin(centre[i]) - (i ? zero : turn)) / thin(e[i]);
            for (int j = free; j < 2; j++) J[i][j] = columns.back()[j][i] / thin(e[i]) - (i == j ? one : zero);
        }
        I a = thin(middle(J[0][0])), b = thin(middle(J[0][1])), g = thin(middle(J[1][0])), d = thin(middle(J[1][1]));
        I det = a * d - b * g;
        if (!positive(det) && !negative(det)) undecided("a closing equation that may be singular");
        I Y[2][2] = {{d / det, -b / det}, {-g / det, a / det}}, s[2];
        for (auto& row : Y) for (I& each : row) each = thin(middle(each));
        for (int i = 0; i < 2; i++) {
            I spread = zero;
            for (int j = 0; j < 2; j++) spread = spread + plus_minus((i == j ? one : zero) - Y[i][0] * J[0][j] - Y[i][1] * J[1][j]);
            if (spread.hi >= one.hi) undecided("at most one orbit in the box");  // J is regular
            s[i] = spread - Y[i][0] * off[0] - Y[i][1] * off[1];
            if (round == 0) s[i] = meet(s[i], plus_minus(one));
            else if (!within(s[i], plus_minus(one))) undecided("an orbit in the box");
        }
        bool narrow = true;
        for (size_t n = 0; n < events.size(); n++)
            for (int i = 0; i < 2; i++) {
                I value = centres[n][i] + s[0] * columns[n][0][i] + s[1] * columns[n][1][i], place = i ? events[n].x : events[n].t;
                if (value.hi < place.lo || value.lo > place.hi) refuse("where an event of the orbit is");
                narrow = narrow && within(value, place);
            }
        if (narrow && round > 1) {
            I T = (J[0][0] + J[1][1]) + integer(2), D = stuck ? zero : (J[0][0] + one) * (J[1][1] + one) - J[0][1] * J[1][0];
            if (free) D = stuck ? zero : J[1][1] + one, T = one + D;
            auto polynomial = [&](const I& z) { return z * z - T * z + D; };
            bool real = stated[0][2].lo == 0 && stated[0][3].hi == 0 && stated[1][2].lo == 0 && stated[1][3].hi == 0;
            for (int i = 0; i < 2; i++) {
                I low = thin(stated[i][0].lo), high = thin(stated[i][1].hi);
                if (stuck && i == 1) {
                    if (low.lo != 0 || high.hi != 0 || !real) refuse("a multiplier that is 0");
                } else if (stuck) {
                    inside(T, {low.lo, high.hi}, "a multiplier");
                } else if (real) {
                    I p = polynomial(low), q = polynomial(high);
                    if (!(positive(p) && negative(q)) && !(negative(p) && positive(q))) undecided("a real multiplier");
                } else {
                    inside(over(T, 2), {low.lo, high.hi}, "the real part of a multiplier");
                    I square = D - over(T * T, 4), from = i ? -stated[i][3] : stated[i][2], to = i ? -stated[i][2] : stated[i][3];
                    if (!positive(from)) refuse("imaginary parts of another sign");
                    if (!positive(square - from * from) || !positive(to * to - square)) undecided("an imaginary part");
                }
            }
            if (real && !stuck && !(stated[0][0].lo > stated[1][1].hi || stated[1][0].lo > stated[0][1].hi)) undecided("two multipliers");
            I size = plus_minus(D), trace = plus_minus(T);
            if (free) trace = zero, T = zero;  // the multiplier 1 is that of the phase
            bool in = positive(one - thin(size.hi)) && positive(one + D - thin(trace.hi));
            bool out = negative(one - D) || negative(one + D - T) || negative(one + D + T);
            if (stable >= 0 && !in && !out) undecided("stability");
            if (stable >= 0 && stable != in) refuse("stability");
            return;
        }
        if (round > 3) undecided("a narrower box around the orbit");
        for (int i = free; i < 2; i++) {  // a smaller box around the orbit, in the one where it is alone
            I place = thin(centre[i]) + s[i] * thin(e[i]);
            centre[i] = middle(place), e[i] = place.hi - place.lo + 4;
            if (abs(centre[i] - first[i]) + e[i] >= most[i]) undecided("a smaller box in the other");
        }
    }
}

int main() {
    try {
        std::string kind;
        std::cin >> bits >> kind;
        read_oscillator();
        if (kind == "trajectory") trajectory();
        else if (kind == "orbit") orbit();
        else refuse("a kind that is not known");
        std::cout << "proven\n";
        return 0;
    } catch (const Refuse& r) {
        std::cout << (r.code == 1 ? "not proven: " : "undecided: ") << r.why << "\n";
        return r.code;
    } catch (const std::exception& error) {
        std::cout << "not proven: " << error.what() << "\n";
        return 1;
    }
}
