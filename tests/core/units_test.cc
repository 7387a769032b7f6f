#include "vdb_offset/core/units.h"

#include <doctest/doctest.h>

#include <cmath>
#include <random>

#include "vdb_offset/core/error.h"

using namespace vdb_offset;

TEST_CASE("units: bytes are shown in the unit that leaves one to four digits") {
  CHECK(format_bytes(0) == "0 B");
  CHECK(format_bytes(1023) == "1023 B");
  CHECK(format_bytes(1024) == "1.00 KiB");
  CHECK(format_bytes(1610612736) == "1.50 GiB");
  CHECK(format_bytes(1024.0 * 1024.0 - 1.0) == "1.00 MiB");
  CHECK(format_bytes(std::ldexp(1.0, 50)) == "1.00 PiB");
}

TEST_CASE("units: every suffix is a power of 1024, in any case and with spaces") {
  CHECK(parse_bytes("1048576") == 1048576);
  CHECK(parse_bytes("4G") == 4ull << 30);
  CHECK(parse_bytes("512MiB") == 512ull << 20);
  CHECK(parse_bytes("1.5 GB") == 3ull << 29);
  CHECK(parse_bytes(" 2 tib ") == 2ull << 40);
  CHECK(parse_bytes("3k") == 3072);
  CHECK(parse_bytes("7 B") == 7);
  CHECK(parse_bytes("0") == 0);
}

TEST_CASE("units: what is no number of bytes is refused") {
  for (const char* text : {"", " ", "G", "-1", "-2G", "nan", "inf", "infinity", "4X", "4GG",
                           "4 G B", "0x10", "1e30", "17179869184G", "1,5G", "--1", "4iB"}) {
    CAPTURE(text);
    CHECK_THROWS_AS(parse_bytes(text), InputError);
  }
}

TEST_CASE("units: what format_bytes shows, parse_bytes takes back within the digits shown") {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> exponent(10.0, 53.0);
  for (int round = 0; round < 1000; ++round) {
    const double bytes = std::floor(std::exp2(exponent(random)));
    const double again = static_cast<double>(parse_bytes(format_bytes(bytes)));
    CAPTURE(bytes);
    // Two decimals of a number that is at least 1, and the whole byte that floor() drops.
    CHECK(std::abs(again - bytes) <= 0.005 * bytes + 1.0);
  }
}

TEST_CASE("units: half a turn is pi radians and back") {
  CHECK(radians(180.0) == doctest::Approx(std::acos(-1.0)).epsilon(1e-15));
  CHECK(degrees(radians(33.0)) == doctest::Approx(33.0).epsilon(1e-15));
}
