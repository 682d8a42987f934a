// Follows the reference cases with Dormand and Prince's Runge-Kutta pair of order 5, and writes the events that it finds.
//
//     g++ -O2 -std=c++17 -o dopri dopri.cpp && ./dopri cases/cases.csv mine.csv && symosc score cases mine.csv
//
// A step whose end is beyond a belt is repeated with a length that is bisected. So two roots within one step are not
// seen, as with most solvers. Cases of 1e5 periods and cases that take too many steps are left out.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <map>
#include <sstream>
#include <string>
#include <vector>

struct State { double t, x, v; };
struct Case { std::string name; double m, c, k, A0, B0, Om, v1, v2, mu1, mu2, FN, t_end; State start; };
struct Event { double t, x; const char *kind; int belt; };
const double TOLERANCE = 1e-13;
const long MOST_STEPS = 2000000;
struct TooLong {};

double number(const std::string &text) {  // "0.8", "1e-9" or "4/5"
    size_t bar = text.find('/');
    return bar == std::string::npos ? std::stod(text) : (double)(std::stold(text.substr(0, bar)) / std::stold(text.substr(bar + 1)));
}

double force(const Case &p, int domain, const State &s) {  // the acceleration that a domain gives
    double friction = domain == 1 ? p.mu1 + p.mu2 : domain == 2 ? p.mu2 - p.mu1 : -p.mu1 - p.mu2;
    return (p.A0 + friction * p.FN + p.B0 * std::cos(p.Om * s.t) - p.k * s.x - p.c * s.v) / p.m;
}

State step(const Case &p, int domain, const State &s, double h, double &error) {
    static const double A[7][6] = {{}, {1. / 5}, {3. / 40, 9. / 40}, {44. / 45, -56. / 15, 32. / 9},
        {19372. / 6561, -25360. / 2187, 64448. / 6561, -212. / 729},
        {9017. / 3168, -355. / 33, 46732. / 5247, 49. / 176, -5103. / 18656},
        {35. / 384, 0, 500. / 1113, 125. / 192, -2187. / 6784, 11. / 84}};
    static const double C[7] = {0, .2, .3, .8, 8. / 9, 1, 1};
    static const double E[7] = {71. / 57600, 0, -71. / 16695, 71. / 1920, -17253. / 339200, 22. / 525, -1. / 40};
    double kx[7], kv[7], ex = 0, ev = 0;
    State at = s;
    for (int i = 0; i < 7; ++i) {
        at = {s.t + C[i] * h, s.x, s.v};
        for (int j = 0; j < i; ++j) { at.x += h * A[i][j] * kx[j]; at.v += h * A[i][j] * kv[j]; }
        kx[i] = at.v; kv[i] = force(p, domain, at);
        ex += h * E[i] * kx[i]; ev += h * E[i] * kv[i];
    }
    error = std::max(std::fabs(ex) / (1 + std::fabs(at.x)), std::fabs(ev) / (1 + std::fabs(at.v)));
    return at;  // the last stage is the result
}

// Fly in a domain to the next belt (returned) or to the end (0).
int fly(const Case &p, int domain, State &s, double &h, long &steps) {
    double low = domain == 1 ? -INFINITY : domain == 2 ? p.v1 : p.v2, high = domain == 1 ? p.v1 : domain == 2 ? p.v2 : INFINITY, error;
    while (s.t < p.t_end) {
        if (++steps > MOST_STEPS) throw TooLong();
        h = std::min(h, p.t_end - s.t);
        State next = step(p, domain, s, h, error);
        double factor = std::min(5., std::max(.2, .9 * std::pow(TOLERANCE / (error + 1e-30), .2)));
        if (error > TOLERANCE && h > 1e-14 * (1 + std::fabs(s.t))) { h *= factor; continue; }
        if (next.v < low || next.v > high) {  // find the step that ends on the belt
            bool up = next.v > high;
            double a = 0, b = h, wall = up ? high : low;
            for (int i = 0; i < 60; ++i) {
                double middle = (a + b) / 2;
                ((step(p, domain, s, middle, error).v > wall) == up ? b : a) = middle;
            }
            s = step(p, domain, s, b, error);
            s.v = wall;
            return domain == 2 ? (up ? 2 : 1) : domain == 1 ? 1 : 2;
        }
        s = next;
        h *= factor;
    }
    return 0;
}

// Ride on a belt until a force lets go; return the domain that the mass slips into, 0 at the end.
int ride(const Case &p, int belt, State &s, long &steps) {
    double h = .002 * std::min(6.2831853071795865 / p.Om, p.t_end - s.t);
    auto at = [&](double tau) { return State{s.t + tau, s.x + s.v * tau, s.v}; };
    auto slips = [&](double tau) { return force(p, belt, at(tau)) < 0 ? belt : force(p, belt + 1, at(tau)) > 0 ? belt + 1 : 0; };
    for (double tau = 0; s.t + tau < p.t_end; tau += h) {
        if (++steps > MOST_STEPS) throw TooLong();
        if (!slips(tau + h)) continue;
        double a = tau, b = tau + h;
        for (int i = 0; i < 60; ++i) { double middle = (a + b) / 2; (slips(middle) ? b : a) = middle; }
        if (s.t + b >= p.t_end) return 0;
        int domain = slips(b);
        s = at(b);
        return domain;
    }
    return 0;
}

std::vector<Event> follow(const Case &p) {
    State s = p.start;
    std::vector<Event> events;
    int belt = s.v == p.v1 ? 1 : s.v == p.v2 ? 2 : 0, domain = s.v < p.v1 ? 1 : s.v < p.v2 ? 2 : 3;
    double h = 1e-3 / p.Om;
    for (long steps = 0; s.t < p.t_end;) {
        if (belt) {
            int from = domain, old = events.size();
            double below = force(p, belt, s), above = force(p, belt + 1, s);
            if (below > 0 && above < 0) {
                if (s.t > p.start.t) events.push_back({s.t, s.x, "stick", belt});
                domain = ride(p, belt, s, steps);
                if (!domain) break;
                events.push_back({s.t, s.x, "slip", belt});
            } else {
                domain = above >= 0 ? belt + 1 : belt;
                if (s.t > p.start.t && domain != from) events.push_back({s.t, s.x, "cross", belt});
            }
            h = std::min(h, 1e-3 / p.Om);
            if ((int)events.size() == old && ++steps > MOST_STEPS) throw TooLong();
        }
        belt = fly(p, domain, s, h, steps);
    }
    return events;
}

int main(int count, char **words) {
    if (count != 3) { std::fprintf(stderr, "usage: dopri cases.csv results.csv\n"); return 2; }
    std::ifstream table(words[1]);
    FILE *out = std::fopen(words[2], "w");
    if (!table || !out) { std::fprintf(stderr, "dopri: cannot open %s or %s\n", words[1], words[2]); return 2; }
    std::string line, cell;
    std::vector<std::string> heads;
    std::fprintf(out, "case,t,x,kind,boundary,seconds\n");
    while (std::getline(table, line)) {
        std::map<std::string, std::string> row;
        std::vector<std::string> cells;
        for (std::stringstream stream(line); std::getline(stream, cell, ',');) cells.push_back(cell);
        if (heads.empty()) { heads = cells; continue; }
        for (size_t i = 0; i < cells.size(); ++i) row[heads[i]] = cells[i];
        if (row["periods"] != "0") continue;
        auto get = [&](const char *name) { return number(row[name]); };
        Case p{row["name"], get("m"), get("c"), get("k"), get("A0"), get("B0"), get("Omega"), get("v1"), get("v2"),
               get("mu1"), get("mu2"), get("FN"), get("t_end"), {get("t0"), get("x0"), get("v0")}};
        auto begin = std::chrono::steady_clock::now();
        try {
            std::vector<Event> events = follow(p);
            double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
            for (const Event &e : events) std::fprintf(out, "%s,%.17g,%.17g,%s,%d,\n", p.name.c_str(), e.t, e.x, e.kind, e.belt);
            std::fprintf(out, "%s,%.17g,,end,,%.3g\n", p.name.c_str(), p.t_end, seconds);
        } catch (TooLong) { std::fprintf(stderr, "%s: too many steps\n", p.name.c_str()); }
    }
    return std::fclose(out) ? 2 : 0;
}
