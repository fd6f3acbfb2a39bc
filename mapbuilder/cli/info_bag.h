// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mapbuilder/unpack/survey_plan.h"

namespace floorloc {

/// Prints what a bag holds and what it lacks for a survey, as text or as JSON.
void PrintBag(const BagSummary& bag, const SurveyPlan& plan, bool json);

}  // namespace floorloc
