// What may be wrong with the columns of a table of recordings, each as the correction that would
// mend it: two columns exchanged, a sign, a unit, the order of a quaternion, measurements that
// stand beside the readings of another row.
//
// A correction is plain data: new column `target`, row k, is `factor` times the recorded `source`,
// row k + shift, from row `from` on.
#pragma once

#include <string>
#include <vector>

#include "framework/kinematics/program.h"
#include "framework/recordings/recordings.h"

namespace talus {

struct Correction {
  struct Column {
    std::string target, source;
    double factor = 1;
  };
  std::string kind;   // "swapped-columns", "wrong-sign", "wrong-unit", "quaternion-order", ...
  std::string where;  // the model's sensors or measurements: "encoder2, encoder3"
  std::string
      statement;  // what is wrong, as a clause: "the columns theta2 and theta5 are exchanged"
  std::vector<Column> columns;
  int shift = 0;         // of all columns named, in rows
  std::size_t from = 0;  // row from which it holds
  bool of_measurements = false;
};

// Where a row is shifted beyond the table, the value is missing.
Recordings corrected(const Recordings& recordings, const Correction& correction);

// All that are tried, but for shifted rows.
std::vector<Correction> column_corrections(const Program& program, const Recordings& recordings);
// Measurements of row k + shift belong to row k, from row `from` on.
Correction row_correction(const Program& program, const Recordings& recordings, int shift,
                          std::size_t from);

}  // namespace talus
