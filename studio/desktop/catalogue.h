// Help > Effects: every effect that a model may lack, with its formula, parameters and source.
#pragma once

class QWidget;

namespace underbody::studio {

void show_effect_catalogue(QWidget* parent);

}  // namespace underbody::studio
