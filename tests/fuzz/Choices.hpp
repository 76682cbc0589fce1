// Choices made by the bytes of an input, so that a fuzzer that changes bytes changes choices, and one input always makes the same.
#pragma once
#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

namespace malus::fuzzing {
class Choices {
 public:
  Choices(const std::uint8_t* data, std::size_t size) : data_(data), left_(size) {}
  std::size_t left() const { return left_; }
  std::uint8_t byte() {
    if (left_ == 0) return 0;
    return --left_, *data_++;
  }
  std::size_t below(std::size_t count) {
    return count == 0 ? 0 : (byte() << 8 | byte()) % count;
  }
  template <class Value>
  const Value& of(const std::vector<Value>& list) {
    return list[below(list.size())];
  }
  /// A number in which something may go wrong: a limit of a type, a hair beside a round number, or any bits.
  double number() {
    static const std::vector<double> hard{0,
                                          -0.0,
                                          1,
                                          -1,
                                          2,
                                          0.5,
                                          90,
                                          180,
                                          360,
                                          -90,
                                          400,
                                          550,
                                          1e-3,
                                          1e3,
                                          1e6,
                                          1e9,
                                          1e10,
                                          2e18,
                                          1e19,
                                          1e38,
                                          4e38,
                                          1e300,
                                          1e308,
                                          -1e300,
                                          -1e9,
                                          -1e10,
                                          1e-9,
                                          1e-10,
                                          1e-38,
                                          1e-300,
                                          5e-324,
                                          2147483647.,
                                          2147483648.,
                                          4294967299.,
                                          9007199254740993.,
                                          9223372036854775807.,
                                          18446744073709551615.,
                                          -9223372036854775808.};
    if (byte() % 4) return of(hard);
    std::uint64_t bits = 0;
    for (int i = 0; i < 8; ++i) bits = bits << 8 | byte();
    double any = 0;
    std::memcpy(&any, &bits, sizeof any);
    return any;
  }

 private:
  const std::uint8_t* data_;
  std::size_t left_;
};
}  // namespace malus::fuzzing
