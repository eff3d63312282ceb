#pragma once

#include "wellgyro/io/toml/toml_writer_internal.h"
#include "wellgyro/record/run_lesson.h"

namespace wellgyro {

/// [run.fit.lesson]: in SI units, of the errors that were unknowns.
void WriteRunLesson(TomlWriter& toml, const RunLesson& lesson);

}  // namespace wellgyro
