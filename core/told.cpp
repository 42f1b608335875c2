#include "core/told.h"

#include <algorithm>
#include <iterator>
#include <utility>

#include "core/text.h"
#include "core/units.h"

namespace underbody::core {

std::string_view told_unit(std::string_view si) {
    constexpr std::pair<std::string_view, std::string_view> told[] = {
        {"m", "mm"}, {"rad", "deg"}, {"1/rad", "1/deg"}, {"N/rad", "N/deg"}, {"N m/rad", "N m/deg"}};
    const auto* const found =
        std::find_if(std::begin(told), std::end(told), [&](const auto& one) { return one.first == si; });
    return found == std::end(told) ? si : found->second;
}

std::string_view told_unit_of(std::string_view quantity, std::string_view si) {
    return quantity == "depth" ? si : told_unit(si);
}

std::string told(double value, std::string_view si, int digits) {
    if (si.empty() || si == "1") {
        return format_number(value, digits);
    }
    const std::string_view unit = told_unit(si);
    return format_number(convert(value, si, unit), digits) + " " + std::string(unit);
}

std::string told(double value, double sigma, std::string_view si, int digits) {
    const std::string_view unit = told_unit(si);
    return format_number(si == unit ? value : convert(value, si, unit), digits) + " +- " + told(sigma, si, 2);
}

std::string told_condition(const std::string& name, double value, int digits) {
    const QuantityName* known = find_quantity(name);
    const std::string_view si = known != nullptr && known->unit != "1" ? std::string_view(known->unit) : "";
    const std::string_view unit = told_unit_of(name, si);
    return name + " " + format_number(si == unit ? value : convert(value, si, unit), digits) +
           (unit.empty() ? "" : " " + std::string(unit));
}

std::string told_range(double lower, double upper, std::string_view si, int digits) {
    const bool pure = si.empty() || si == "1";
    return format_number(pure ? lower : convert(lower, si, told_unit(si)), digits) + " to " + told(upper, si, digits);
}

}  // namespace underbody::core
