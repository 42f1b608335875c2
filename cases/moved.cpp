#include "cases/moved.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <tuple>

#include "core/normal.h"

namespace underbody::cases {

using nlohmann::json;

namespace {

using core::beyond_sigmas;
constexpr double rounding = 1e-9;  ///< of the size
const double unknown = std::nan("");

json json_number(double value) { return std::isfinite(value) ? json(value) : json(); }

}  // namespace

double Moved::sigma() const {
    if (std::isnan(sigma_a) && std::isnan(sigma_b)) {
        return unknown;
    }
    return std::hypot(std::isnan(sigma_a) ? 0 : sigma_a, std::isnan(sigma_b) ? 0 : sigma_b);
}

double Moved::in_sigma() const {
    const double joint = sigma();
    return joint > 0 ? std::abs(difference()) / joint : unknown;
}

double Moved::of_size() const { return size > 0 ? std::abs(difference()) / size : 0; }

std::string to_string(Shift shift) {
    switch (shift) {
        case Shift::beyond:
            return "beyond its error";
        case Shift::unjudged:
            return "no error known";
        case Shift::within:
            return "within its error";
        case Shift::same:
            return "same";
        case Shift::only_one:
            break;
    }
    return "on one side only";
}

void judge(Moved& one) {
    const double difference = std::abs(one.difference());
    if (std::isnan(one.a) || std::isnan(one.b)) {
        one.shift = std::isnan(one.a) && std::isnan(one.b) ? Shift::same : Shift::only_one;
    } else if (difference <= rounding * std::max(one.size, std::max(std::abs(one.a), std::abs(one.b)) * 1e-3)) {
        one.shift = Shift::same;
    } else if (std::isnan(one.sigma()) ||
               ((std::isnan(one.sigma_a) || std::isnan(one.sigma_b)) && difference > beyond_sigmas * one.sigma())) {
        one.shift = Shift::unjudged;  // one side's error alone can say "within", never "beyond"
    } else {
        one.shift = difference > beyond_sigmas * one.sigma() ? Shift::beyond : Shift::within;
    }
}

bool moved_more(const Moved& a, const Moved& b) {
    const auto key = [](const Moved& one) {
        const double errors = one.in_sigma();
        return std::tuple(one.shift == Shift::only_one ? -1 : static_cast<int>(one.shift),
                          std::isnan(errors) ? 0 : -errors, -one.of_size());
    };
    return key(a) < key(b);
}

void to_json(json& all, const Moved& one) {
    all = {{"name", one.name},
           {"unit", one.unit},
           {"a", json_number(one.a)},
           {"b", json_number(one.b)},
           {"difference", json_number(one.difference())},
           {"sigma_a", json_number(one.sigma_a)},
           {"sigma_b", json_number(one.sigma_b)},
           {"sigma", json_number(one.sigma())},
           {"in_sigma", json_number(one.in_sigma())},
           {"of_size", json_number(one.of_size())},
           {"shift", to_string(one.shift)}};
}

}  // namespace underbody::cases
