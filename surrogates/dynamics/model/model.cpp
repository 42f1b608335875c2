#include "surrogates/dynamics/model/model.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/text.h"
#include "surrogates/dynamics/model/force_sources.h"
#include "surrogates/dynamics/model/model_items.h"

namespace underbody::dynamics {

namespace {

/// The number behind "force.N...."; nullptr when the name does not fit.
double* force_number(Model& model, const std::string& name) {
    const std::vector<std::string_view> parts = core::split(name, '.');
    if (parts.size() < 3 || parts[0] != "force") {
        return nullptr;
    }
    const auto index = core::parse_integer(parts[1]);
    if (!index || *index < 1 || *index > static_cast<long long>(model.forces.size())) {
        return nullptr;
    }
    ForceSource& source = model.forces[static_cast<std::size_t>(*index - 1)];
    if (parts.size() == 3 && parts[2] == "factor") {
        return &source.factor;
    }
    if (parts.size() == 5 && parts[2] == "scale") {
        for (ForceScale& scale : source.scales) {
            if (parts[3] == channel_name(scale.channel)) {
                return parts[4] == "exponent"    ? &scale.exponent
                       : parts[4] == "reference" ? &scale.reference
                       : parts[4] == "dead_band" ? &scale.dead_band
                                                 : nullptr;
            }
        }
    }
    return nullptr;
}

double* number_of(Model& model, const std::string& name) {
    for (const ModelItem& item : model_items()) {
        if (name == std::string(item.section) + "." + item.key) {
            return &item.of(model);
        }
    }
    return force_number(model, name);
}

[[noreturn]] void refuse(const Model& model, const std::string& name) {
    std::vector<std::string> known;
    for (const DeclaredParameter& parameter : model.parameters()) {
        known.push_back(parameter.name);
    }
    throw core::InputError("name", "the model has no number called '" + name + "'", {model.name, {}, {}, {}},
                           core::did_you_mean(name, known));
}

}  // namespace

std::vector<DeclaredParameter> Model::parameters() const {
    std::vector<DeclaredParameter> all;
    Model& self = const_cast<Model&>(*this);  // the accessors only hand out a reference, which is read here
    const auto is_declared = [this](const std::string& full) {
        return std::find(declared.begin(), declared.end(), full) != declared.end();
    };
    for (const ModelItem& item : model_items()) {
        const std::string full = std::string(item.section) + "." + item.key;
        all.push_back({full, item.unit, item.of(self), item.lower, item.upper, is_declared(full), item.meaning});
    }
    for (std::size_t i = 0; i < forces.size(); ++i) {
        const std::string prefix = "force." + std::to_string(i + 1) + ".";
        all.push_back({prefix + "factor", "1", forces[i].factor, -1e3, 1e3, true,
                       "factor on the whole table of " + forces[i].quantity});
        for (const ForceScale& scale : forces[i].scales) {
            const std::string where = prefix + "scale." + channel_name(scale.channel) + ".";
            const char* unit = channel_unit(scale.channel);
            all.push_back({where + "exponent", "1", scale.exponent, -10, 10, true, "power of the scale"});
            all.push_back(
                {where + "reference", unit, scale.reference, 1e-12, 1e12, true, "where the table holds as it is"});
            all.push_back({where + "dead_band", unit, scale.dead_band, 0, 1e12, true, "below it there is no force"});
        }
    }
    return all;
}

double Model::parameter(const std::string& dotted_name) const {
    if (const double* value = number_of(const_cast<Model&>(*this), dotted_name)) {
        return *value;
    }
    refuse(*this, dotted_name);
}

Model Model::with_parameter(const std::string& dotted_name, double value) const {
    Model result = *this;
    double* number = number_of(result, dotted_name);
    if (!number) {
        refuse(*this, dotted_name);
    }
    for (const ModelItem& item : model_items()) {
        if (dotted_name == std::string(item.section) + "." + item.key) {
            check_item(item, value, {name, {}, {}, {}});
        }
    }
    *number = value;
    if (std::find(result.changed.begin(), result.changed.end(), dotted_name) == result.changed.end()) {
        result.changed.push_back(dotted_name);
    }
    return result;
}

double RecordReading::factor_of(const std::string& column) const {
    if (column == "input_force" || column == "heave_velocity") {
        return column == "input_force" ? input_factor : velocity_factor;
    }
    const auto found = factors.find(column);
    return found != factors.end() ? found->second : 1;
}

void RecordReading::scale(const std::string& column, double factor) {
    if (column == "input_force") {
        input_factor *= factor;
    } else if (const double all = factor_of(column) * factor; all != 1) {
        factors[column] = all;
    } else {
        factors.erase(column);
    }
}

Model Model::with_effect(EffectUse use) const {
    Model result = *this;
    result.effects.push_back(std::move(use));
    return result;
}

Model Model::resolved() const {
    Model result = *this;
    std::vector<EffectUse> kept;
    for (const EffectUse& use : effects) {
        if (!use.parameter.empty()) {
            result = result.with_parameter(use.parameter, use.values.at(0));
        } else {
            kept.push_back(use);
        }
    }
    result.effects = std::move(kept);
    return result;
}

std::vector<std::string> Model::quantities() const {
    std::vector<std::string> names;
    for (const ForceSource& source : forces) {
        if (std::find(names.begin(), names.end(), source.quantity) == names.end()) {
            names.push_back(source.quantity);
        }
    }
    return names;
}

double sum_of_sources(const Model& model, const std::string& quantity, const Conditions& seen, bool* outside) {
    double sum = 0;
    for (const ForceSource& source : model.forces) {
        if (source.quantity != quantity) {
            continue;
        }
        double point[tables::max_axes] = {};
        for (std::size_t i = 0; i < source.axes.size(); ++i) {
            double value = seen[source.axes[i]];
            if (std::isnan(value)) {
                if (source.axes[i] != Channel::pitch && source.axes[i] != Channel::pitch_rate) {
                    throw core::InputError(
                        "missing",
                        std::string("the set point has no ") + channel_name(source.axes[i]) + ", an axis of " +
                            source.table_file,
                        {model.name, {}, {}, {}},
                        "give it as a column, a condition of the run, or under [conditions] in the model");
                }
                value = 0;
            }
            point[i] = value;
            const tables::TableAxis& axis = source.table.axes()[i];
            if (outside && (value < axis.lower || value > axis.upper)) {
                *outside = true;
            }
        }
        double factor = source.factor;
        if (model.coupling.kind == Coupling::Kind::sheltered && driven_by_jet(source)) {
            factor *= shelter_factor(seen[Channel::speed], model.coupling.limit_speed);
        }
        for (const ForceScale& scale : source.scales) {
            factor *= scale_factor(scale, seen[scale.channel]);
        }
        sum += factor * source.table.value(point);
    }
    return sum;
}

Conditions references_of(const Model& model) {
    Conditions references;
    std::array<bool, channel_count> several{};
    for (const ForceSource& source : model.forces) {
        for (const ForceScale& scale : source.scales) {
            several[static_cast<std::size_t>(scale.channel)] |=
                references.has(scale.channel) && references[scale.channel] != scale.reference;
            references[scale.channel] = scale.reference;
        }
    }
    for (std::size_t i = 0; i < channel_count; ++i) {
        references.value[i] = several[i] ? std::nan("") : references.value[i];
    }
    return references;
}

StaticModel::StaticModel(const Model& model, const std::string& quantity)
    : model_(model.resolved()), quantity_(quantity) {
    model_.conditions = model_.conditions.over(references_of(model_));
    // Corrections add to the force as the vehicle's other effects leave it, as in the equation of motion.
    std::stable_partition(model_.effects.begin(), model_.effects.end(), [](const EffectUse& use) {
        const EffectInfo& info = effect(use.name).info();
        return !info.takes_table && !info.belongs_to_the_rig;
    });
    for (const EffectUse& use : model_.effects) {
        kinds_.push_back(&effect(use.name));
    }
}

StaticPoint StaticModel::before(const Conditions& set_point) const {
    StaticPoint seen{set_point.over(model_.conditions), &model_};
    for (std::size_t i = 0; i < kinds_.size(); ++i) {
        kinds_[i]->before(seen, model_.effects[i]);
    }
    return seen;
}

Conditions StaticModel::seen(const Conditions& set_point) const { return before(set_point).conditions; }

double StaticModel::operator()(const Conditions& set_point, bool* outside) const {
    const StaticPoint seen = before(set_point);
    const Conditions asked = set_point.over(model_.conditions);
    double value = sum_of_sources(model_, quantity_, seen.conditions, outside);
    for (std::size_t i = 0; i < kinds_.size(); ++i) {
        value = kinds_[i]->after(quantity_, value, seen, asked, model_.effects[i]);
    }
    return value;
}

double static_value(const Model& model, const std::string& quantity, const Conditions& set_point, bool* outside) {
    return StaticModel(model, quantity)(set_point, outside);
}

}  // namespace underbody::dynamics
