// A recorded input that comes late, or that is turned round or a thousand times off: a matter of the log, no effect.
// One search and one wording for predictions and discovery.
#pragma once

#include <cmath>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/error.h"
#include "core/no_limit.h"
#include "surrogates/dynamics/model/measurements.h"
#include "surrogates/dynamics/model/model.h"

namespace underbody::dynamics {

/// How recorded inputs are read: all of them so much earlier, or one of them times a factor.
struct InputAsLogged {
    double early = 0;  ///< s
    double factor = 1;
    std::string column{};  ///< that the factor is of
    [[nodiscard]] bool as_logged() const { return early == 0 && factor == 1; }
    [[nodiscard]] bool clock() const { return factor == 1; }
};

/// What is asked of the recorded inputs.
struct InputSearch {
    std::vector<std::string> columns;
    double as_logged = 0;       ///< -2 log likelihood of the likeliest effect alone, of the same readings as `cost`
    bool gain = false;          ///< it is a gain of an input: the scale of one of `columns` is likelier than that name
    double longest = INFINITY;  ///< s: inputs that are later are not looked for
    std::function<double(const InputAsLogged&)> cost;
};
/// The likeliest reading where it is likelier than the inputs as logged beyond chance; else as logged.
InputAsLogged better_input(const InputSearch& search);

/// `records` with the inputs `columns` read so as well.
RecordReading with_inputs(RecordReading records, const InputAsLogged& inputs, const std::vector<std::string>& columns);

/// "input_force 0.2 s earlier", "input_moment times -1"; `columns`: all that there are.
std::string mended_text(const InputAsLogged& reading, const std::vector<std::string>& columns);
/// Why it is likely, without an end: what is done about it.
std::string doubt_text(const InputAsLogged& reading, const std::vector<std::string>& columns);

/// How many independent errors hold as much as these: the errors of a model that is wrong are as smooth as the motion,
/// and a second of them says no more than one. By the sum of their autocorrelation, up to its first zero.
double independent_count(const std::vector<double>& errors);

/// A warning where predictions of the data are far from the readings, and most of what is more than noise goes once the
/// inputs are read in another way. `errors`: of the predictions with the logs read so, in noise, always of the same
/// readings up to what a late input leaves unknown; `records`: as they were predicted; `inputs`: columns that may be
/// doubted, of which those count that move in some run.
std::optional<core::Problem> doubtful_input(const Measurements& data, const std::vector<std::string>& inputs,
                                            const RecordReading& records,
                                            const std::function<std::vector<double>(const RecordReading&)>& errors);

}  // namespace underbody::dynamics
