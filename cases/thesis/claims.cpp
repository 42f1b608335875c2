#include "cases/thesis/claims.h"

#include <nlohmann/json.hpp>

namespace underbody::thesis {

const core::Figure* Study::figure(const std::string& number) const {
    for (const auto& [name, f] : figures) {
        if (name == number) {
            return &f;
        }
    }
    return nullptr;
}

void to_json(nlohmann::json& j, const Study& study) {
    nlohmann::json claims = nlohmann::json::array(), figures = nlohmann::json::array();
    for (const Claim& c : study.claims) {
        claims.push_back({{"id", c.id},
                          {"where", c.where},
                          {"statement", c.statement},
                          {"computed", c.computed},
                          {"verdict", c.verdict}});
    }
    for (const auto& [name, f] : study.figures) {
        figures.push_back({{"number", name}, {"title", f.title}, {"caption", f.caption}});
    }
    j = {{"claims", claims}, {"figures", figures}};
}

}  // namespace underbody::thesis
