// A number on two sides, and whether it moved beyond its error.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

namespace underbody::cases {

/// How a number stands to the one on the other side.
enum class Shift {
    beyond,    ///< they differ by more than twice their joint error
    unjudged,  ///< they differ, and no error is known
    within,    ///< they differ by no more than twice their joint error
    same,      ///< equal but for rounding
    only_one,  ///< there is none on the other side
};
/// "beyond its error", "no error known", "within its error", "same", "on one side only"
std::string to_string(Shift shift);

/// One number on both sides, SI. NaN where there is none.
struct Moved {
    std::string name;  ///< "lift_force", "stable gap", "share of contact", or the table
    std::string unit;
    double a = 0, b = 0;
    double sigma_a = 0, sigma_b = 0;  ///< one standard deviation each; NaN: not known
    double size = 0;                  ///< what the difference is a share of where no error is known
    Shift shift = Shift::same;

    [[nodiscard]] double difference() const { return b - a; }
    [[nodiscard]] double sigma() const;     ///< joint; NaN when neither is known
    [[nodiscard]] double in_sigma() const;  ///< |difference| over it; NaN likewise
    [[nodiscard]] double of_size() const;   ///< |difference| over `size`
};

/// Finds `shift` out of the rest.
void judge(Moved& one);
/// What moved most first: beyond its error by its errors, then without an error by its share.
bool moved_more(const Moved& a, const Moved& b);

void to_json(nlohmann::json& json, const Moved& one);

}  // namespace underbody::cases
