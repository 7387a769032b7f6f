#include "blocks/triad_response.h"

#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <vector>

using namespace vdb_offset;

namespace {

using Exact = long double;

struct Point {
  double trace, det;
};

/// Over signs and magnitudes of D, and T that belong to stretched and to flat cells.
std::vector<Point> many_points() {
  std::vector<Point> points;
  for (int power = -24; power <= 24; ++power) {
    for (const double mantissa : {1.0, 1.37, 2.9}) {
      const double size = std::ldexp(mantissa, power);
      points.push_back({3 + size, size});
      points.push_back({1e-3, -size});
    }
  }
  points.push_back({3, 0});
  return points;
}

struct Response {
  static constexpr double kShape = 0.7 / 3;
  static constexpr double kVolume = 0.15;

  std::vector<double> trace, det, energy;
  std::array<std::vector<double>, 4> derivatives;
  double epsilon;

  Response(const std::vector<Point>& points, double given, bool derive) : epsilon(given) {
    for (const Point& p : points) {
      trace.push_back(p.trace);
      det.push_back(p.det);
    }
    energy.resize(points.size());
    for (std::vector<double>& values : derivatives) values.resize(points.size());
    const TriadResponse of{kShape,
                           kVolume,
                           epsilon,
                           trace.data(),
                           det.data(),
                           energy.data(),
                           derivatives[0].data(),
                           derivatives[1].data(),
                           derivatives[2].data(),
                           derivatives[3].data()};
    if (derive) {
      respond_and_derive(of, points.size());
    } else {
      respond(of, points.size());
    }
  }
};

Exact chi_of(Exact d, Exact epsilon) {
  const Exact root = std::sqrt(epsilon * epsilon + d * d);
  return d > 0 ? (d + root) / 2 : epsilon * epsilon / (root - d) / 2;
}

Exact energy_of(Exact t, Exact d, Exact epsilon) {
  const Exact chi = chi_of(d, epsilon);
  return Exact{Response::kShape} * t / std::pow(chi, Exact{2} / 3) +
         Exact{Response::kVolume} * (d * d + 1) / chi;
}

constexpr std::array kEpsilons{1e-9, 1e-4, 1e-2};

}  // namespace

TEST_CASE("triad response: the energy is its formula's to rounding") {
  const std::vector<Point> points = many_points();
  constexpr Exact kRoundings = 16 * 2.3e-16L;
  for (const double epsilon : kEpsilons) {
    const Response response(points, epsilon, false);
    Exact worst = 0;
    for (std::size_t n = 0; n < points.size(); ++n) {
      const Exact exact = energy_of(points[n].trace, points[n].det, epsilon);
      worst = std::max(worst, std::abs(response.energy[n] / exact - 1));
    }
    CAPTURE(epsilon);
    CHECK(worst < kRoundings);
  }
}

TEST_CASE("triad response: derivatives are those of the formula") {
  const std::vector<Point> points = many_points();
  for (const double epsilon : kEpsilons) {
    const Response response(points, epsilon, true);
    CHECK(response.energy == Response(points, epsilon, false).energy);
    Exact worst = 0;
    for (std::size_t n = 0; n < points.size(); ++n) {
      const Exact t = points[n].trace;
      const Exact d = points[n].det;
      // Differences of the fourth order, over steps that are small against where f changes.
      const Exact length = std::sqrt(d * d + Exact{epsilon} * epsilon);
      const Exact h = 1e-3L * length;
      const auto f = [&](Exact at) { return energy_of(t, at, epsilon); };
      const auto g = [&](Exact at) {
        return Exact{Response::kShape} / std::pow(chi_of(at, epsilon), Exact{2} / 3);
      };
      const auto slope = [&](const auto& of) {
        return (8 * (of(d + h) - of(d - h)) - (of(d + 2 * h) - of(d - 2 * h))) / (12 * h);
      };
      const Exact curve =
          (16 * (f(d + h) + f(d - h)) - (f(d + 2 * h) + f(d - 2 * h)) - 30 * f(d)) / (12 * h * h);
      const auto differs = [&](std::size_t which, Exact exact, Exact scale) {
        worst = std::max(worst, std::abs(response.derivatives[which][n] - exact) / scale);
      };
      differs(0, 2 * g(d), g(d));
      differs(1, slope(f), f(d) / length);
      differs(2, 2 * slope(g), g(d) / length);
      // Of D it is the second derivative where epsilon is small beside it, and more elsewhere.
      const Exact tolerance = 1e-8L * f(d) / (length * length);
      CHECK(response.derivatives[3][n] >= curve - tolerance);
      if (d > 1e5L * epsilon) CHECK(response.derivatives[3][n] <= curve + tolerance);
    }
    CAPTURE(epsilon);
    CHECK(worst < 1e-8L);
  }
}

TEST_CASE("triad response: a cell's bits do not depend on the cells beside it") {
  const std::vector<Point> points = many_points();
  const Response together(points, 1e-4, true);
  for (std::size_t n = 0; n < points.size(); ++n) {
    const Response alone({points[n]}, 1e-4, true);
    CHECK(alone.energy[0] == together.energy[n]);
    for (std::size_t d = 0; d < 4; ++d) {
      CHECK(alone.derivatives[d][0] == together.derivatives[d][n]);
    }
  }
}
