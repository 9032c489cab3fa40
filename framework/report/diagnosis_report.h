// What a diagnosis is told as.
#pragma once

#include "framework/diagnosis/diagnosis.h"
#include "framework/report/report.h"

namespace talus {

std::string diagnosis_text(const Diagnosis& diagnosis, const std::string& extended_model);
std::string diagnosis_json(const Diagnosis& diagnosis, const ReportContext& context,
                           const std::string& extended_model);

}  // namespace talus
