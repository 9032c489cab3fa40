// What the page of each command says and shows. The verdict is put in words here, figures of rows
// held out first; tables are made by the page from the command's JSON report.
#pragma once

#include "framework/calibration/axes_changes.h"
#include "framework/calibration/settings.h"
#include "framework/diagnosis/advice.h"
#include "framework/page/page.h"
#include "framework/report/axes.h"
#include "framework/report/report.h"
#include "framework/report/verdict.h"

namespace talus {

// Fills in headline, sentences, states, use, directions. All that is passed must live as long as
// the content is used.
void page_of_model(PageContent& content, const Program& program);
void page_of_check(PageContent& content, const Program& program, const Recordings& recordings,
                   const Spoken& verdict, const Identifiability& seen, std::span<const double> x);
void page_of_simulation(PageContent& content, const Program& program, const Settings& settings,
                        const Recordings& recordings);
void page_of_fit(PageContent& content, const Program& program, const Recordings& recordings,
                 const Split& split, const Fit& fit);
// `after`: the recordings with what the extended model needs beside them.
void page_of_diagnosis(PageContent& content, const Diagnosis& diagnosis, const Advice& advice,
                       const Recordings& before, const Recordings& after);
void page_of_axes(PageContent& content, const AxisFinder& finder, const AxesResult& result,
                  const std::vector<Recordings>& recordings, const std::vector<std::string>& names);

}  // namespace talus
