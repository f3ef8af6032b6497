#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "common/report/report.hpp"
#include "common/report/run_summary.hpp"
#include "tests/support/synthetic_run.hpp"

namespace farhand {
namespace {

nlohmann::json first_of(const std::vector<RunData>& runs) {
  return nlohmann::json::parse(report_json(runs)).at("recordings").at(0);
}

TEST(RunSummary, FindsTheErrorsTheRunWasMadeWith) {
  const SyntheticRun made;
  const auto j = first_of({synthetic_loopback(made)});
  constexpr double kFloat = 1e-7;  // of positions near 0.4 m
  for (const char* figure : {"rms", "p99", "max"}) {
    EXPECT_NEAR(j["tracking_free_m"][figure], made.tracking_free_m, kFloat) << figure;
    EXPECT_NEAR(j["tracking_contact_m"][figure], made.tracking_contact_m, kFloat) << figure;
    EXPECT_NEAR(j["force_error_free_n"][figure], made.force_error_free_n, kFloat) << figure;
    EXPECT_NEAR(j["force_error_contact_n"][figure], made.force_error_contact_n, kFloat) << figure;
    EXPECT_NEAR(j["torque_error_free_nm"][figure], 0.01, 1e-8) << figure;
    EXPECT_NEAR(j["contact_force_n"][figure], made.contact_n, kFloat) << figure;
  }
  EXPECT_NEAR(j["duration_s"], 1.999, 1e-9);
  EXPECT_NEAR(j["contact_ratio"], 0.5, 1e-9);
  EXPECT_NEAR(j["coupled_ratio"], 1990 / 2000.0, 1e-9);
}

TEST(RunSummary, CountsTicksStatesLimitsAndTheLink) {
  const auto j = first_of({synthetic_loopback({})});
  EXPECT_EQ(j["ticks"]["master"], 2000);
  EXPECT_NEAR(j["READY_ratio"]["slave"], 10 / 2000.0, 1e-9);
  EXPECT_EQ(j["limited_force_ticks"]["master"], 1);
  EXPECT_FALSE(j.contains("limited_slew_ticks"));
  EXPECT_EQ(j["lost"]["master"], 3);
  EXPECT_EQ(j["reordered"]["slave"], 1);
  EXPECT_NEAR(j["jitter_s"]["master"], 20e-6, 1e-12);
  EXPECT_NEAR(j["round_trip_s"]["max"], 200e-6, 1e-9);
}

TEST(RunSummary, EnergyIsTorqueTimesAngleAndForceTimesPath) {
  const SyntheticRun made;
  const auto j = first_of({synthetic_loopback(made)});
  // 0.2 N m over 0.5 rad/s for 1.999 s; 4 N over 10 mm/s for the second half.
  EXPECT_NEAR(j["work_on_hand_j"], 0.2 * 0.5 * 1.999, 1e-6);
  EXPECT_NEAR(j["work_on_environment_j"], 4 * 0.01 * 0.9995, 1e-6);
}

TEST(RunSummary, WhatWasNotRecordedIsLeftOut) {
  const auto j = first_of({synthetic_master({})});
  EXPECT_FALSE(j.contains("tracking_free_m"));
  EXPECT_FALSE(j["ticks"].contains("slave"));
  EXPECT_TRUE(j.contains("force_error_free_n"));
}

TEST(RunSummary, AnEstimateNeverPassesForAMeasurement) {
  SyntheticRun made;
  const auto measured = first_of({synthetic_loopback(made)});
  EXPECT_FALSE(measured.contains("estimated_force_error_free_n"));
  made.user_estimated = true;
  const auto j = first_of({synthetic_loopback(made)});
  EXPECT_FALSE(j.contains("force_error_free_n"));
  EXPECT_NEAR(j["estimated_force_error_free_n"]["rms"], made.force_error_free_n, 1e-7);
  const std::string page = report_html({synthetic_loopback(made)});
  EXPECT_NE(page.find("F_u, user on handle (estimated)"), std::string::npos);
  EXPECT_NE(page.find("free, F_u estimated"), std::string::npos);
  EXPECT_EQ(report_html({synthetic_loopback({})}).find("estimated"), std::string::npos);
}

TEST(RunSummary, ForcesOfCouplingAndBoundaryAreToldWhereRecorded) {
  SyntheticRun made;
  const auto without = first_of({synthetic_loopback(made)});
  EXPECT_FALSE(without.contains("coupling_force_n") || without.contains("boundary_force_n"));
  made.coupling_n = 2, made.boundary_n = 3;
  const auto j = first_of({synthetic_loopback(made)});
  EXPECT_NEAR(j["coupling_force_n"]["rms"], 2, 1e-6);
  EXPECT_NEAR(j["boundary_force_n"]["max"], 3, 1e-6);
  const std::string page = report_html({synthetic_loopback(made)});
  for (const char* name : {"of the coupling to the robot", "of the boundary"})
    EXPECT_NE(page.find(name), std::string::npos) << name;
}

TEST(RunSummary, TablesHaveOneBlockPerRun) {
  const std::vector<RunData> runs{synthetic_loopback({}), synthetic_master({})};
  for (const Table& t : tables(summarize(runs), {"a", "b"}))
    for (const TableRow& row : t.rows)
      EXPECT_EQ(row.cells.size(), 2 * t.headings.size()) << t.caption << ": " << row.label;
}

TEST(RunSummary, JsonSurvivesAnyName) {
  RunData run = synthetic_master({});
  run.files = {"a \"quoted\"\\ name\n.mcap"};
  EXPECT_EQ(first_of({run})["files"][0], run.files[0]);
}

}  // namespace
}  // namespace farhand
