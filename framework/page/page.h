// The report as a page: one HTML file that opens from disk, without network or server. The template
// (markup, style, viewer and charts) is bundled when Talus is built and is part of the library;
// what is added here is data and the functions that move the linkage (javascript.h). Users need no
// node.
//
// A page shows states of a linkage (nominal and calibrated; without and with what a diagnosis has
// found), each with its parameters and, where there are recordings, its poses and residuals.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "framework/diagnosis/curve.h"
#include "framework/kinematics/program.h"
#include "framework/model/model.h"
#include "framework/recordings/recordings.h"

namespace talus {

struct PageState {
  std::string label;  // "nominal", "calibrated"
  const Program* program = nullptr;
  std::vector<double> parameters;               // further entries do not matter
  std::vector<std::vector<double>> poses = {};  // [recorded row][coordinate]; may be none
  const Recordings* recordings = nullptr;       // for what was measured
  Eigen::MatrixXd residuals = {};               // recorded rows x residual rows, NaN: not known
  bool apart = false;  // of a recording of its own, not that of the content
};

// A direction in the space of parameters that the recordings do not see.
struct PageDirection {
  std::string sentence;
  std::size_t state = 0;
  std::vector<std::pair<int, double>> changes;  // slot and amount, any scale
};

struct PageContent {
  std::string command, command_line, title;
  std::string headline;                // the verdict in a few words
  std::vector<std::string> sentences;  // and what it rests on, held-out figures first
  std::string report_json, report_text;
  std::vector<PageState> states;           // the last is what the page begins with
  const Model* model = nullptr;            // its sources are shown
  const Recordings* recordings = nullptr;  // all columns; one row per pose
  std::vector<char> use = {};              // of each row: 'f' fitted, 'c' checked, '-' neither
  std::vector<std::string> sets = {};   // changed in the model, not in its source: joint2.a=300 ?
  std::vector<std::string> files = {};  // read beside the model: recordings, points
  std::vector<PageDirection> directions = {};
  std::vector<std::vector<double>> next = {};  // poses to record next: coordinates of states[0]
  std::vector<Curve> curves = {};              // of the report's findings, then of its hints
};

bool has_page_template();  // built in
// InputError where the template was not built in: how to get it.
std::string write_page(const PageContent& content);

}  // namespace talus
