#include "studio/cli/model_options.h"

#include <algorithm>

#include "core/error.h"
#include "core/text.h"
#include "core/units.h"
#include "studio/cli/option_value.h"

namespace underbody::studio {

const char* set_help() {
    return "a number of the model other than in its file, such as vehicle.net_weight=0.2N (repeatable)";
}

dynamics::Model model_with(const std::string& file, const std::vector<std::string>& set) {
    dynamics::Model model = dynamics::read_model(file);
    for (const auto& assignment : set) {
        const auto [name, text] = name_and_value("--set", assignment);
        static_cast<void>(model.parameter(name));  // says which name was meant
        const auto all = model.parameters();
        const auto declared =
            std::find_if(all.begin(), all.end(), [&, wanted = name](const auto& one) { return one.name == wanted; });
        const std::string unit = core::is_unit(declared->unit) ? declared->unit : "1";
        const double value = option_value("--set " + name, text, unit);
        if (!(value >= declared->lower && value <= declared->upper)) {
            throw core::UsageError("range", "--set " + name + "=" + text + " is out of range", {},
                                   "between " + core::format_number(declared->lower, 6) + " and " +
                                       core::format_number(declared->upper, 6) + " " + unit);
        }
        model = model.with_parameter(name, value);
    }
    return set.empty() ? model : model.resolved();
}

}  // namespace underbody::studio
