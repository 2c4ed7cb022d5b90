// Pinocchio's articulated-body algorithm on a tree of revolute joints, recorded as CasADi's expression graph: what its
// code generation would write. Reads the tree that count.py writes, saves the function beside it and prints the
// accelerations at one state from plain numbers, so that the recording can be checked.
#include <fstream>
#include <iostream>
#include <string>
#include <vector>

#include <pinocchio/autodiff/casadi.hpp>

#include <pinocchio/algorithm/aba.hpp>
#include <pinocchio/multibody.hpp>

namespace pin = pinocchio;
using SX = ::casadi::SX;

pin::Model read(std::istream& tree) {
    const auto number = [&tree] { double v; tree >> v; return v; };
    pin::Model model;
    int joints;
    tree >> joints;
    for (int i = 0; i < joints; ++i) {
        int parent;
        std::string axis;
        tree >> parent >> axis;
        Eigen::Matrix3d R, inertia;
        Eigen::Vector3d p, centre;
        for (int k = 0; k < 9; ++k) R(k / 3, k % 3) = number();
        for (int k = 0; k < 3; ++k) p(k) = number();
        const double mass = number();
        for (int k = 0; k < 3; ++k) centre(k) = number();
        for (int k = 0; k < 9; ++k) inertia(k / 3, k % 3) = number();
        const pin::SE3 place(R, p);
        const std::string name = "joint" + std::to_string(i + 1);
        const auto joint = axis == "JointModelRX"   ? model.addJoint(parent, pin::JointModelRX(), place, name)
                           : axis == "JointModelRY" ? model.addJoint(parent, pin::JointModelRY(), place, name)
                                                    : model.addJoint(parent, pin::JointModelRZ(), place, name);
        model.appendBodyToJoint(joint, pin::Inertia(mass, centre, inertia), pin::SE3::Identity());
    }
    return model;
}

int main(int, char** arguments) {
    std::ifstream tree(arguments[1]);
    const pin::Model model = read(tree);
    const int n = model.nv;

    const auto symbolic = model.cast<SX>();
    auto record = pin::DataTpl<SX>(symbolic);
    const SX q = SX::sym("q", n), v = SX::sym("v", n), tau = SX::sym("tau", n);
    Eigen::Matrix<SX, Eigen::Dynamic, 1> Q(n), V(n), T(n);
    for (int i = 0; i < n; ++i) Q[i] = q(i), V[i] = v(i), T[i] = tau(i);
    pin::aba(symbolic, record, Q, V, T, pin::Convention::LOCAL);
    SX acceleration(n, 1);
    for (int i = 0; i < n; ++i) acceleration(i) = record.ddq[i];
    ::casadi::Function("aba", std::vector<SX>{q, v, tau}, std::vector<SX>{acceleration}).save(arguments[2]);

    pin::Data data(model);
    const Eigen::VectorXd at = Eigen::VectorXd::LinSpaced(n, -0.7, 0.9), speed = at.reverse(), torque = 3 * at;
    std::cout.precision(17);
    std::cout << pin::aba(model, data, at, speed, torque, pin::Convention::LOCAL).transpose() << std::endl;
}
