// Small muscle models with round numbers, as text: an upper arm and a forearm.
#pragma once

#include <string>

namespace bodyopt::testing {

// A ball of the hip kind at height 1 m, a hinge 0.5 m below it. The muscle runs in front of the hinge: a fixed point, a
// conditional one (on while the hinge is at 0.5 rad or more), a moving one.
inline std::string small_osim() {
  return R"(<?xml version="1.0"?>
<OpenSimDocument Version="40000">
 <Model name="limb">
  <length_units>meters</length_units>
  <BodySet><objects>
   <Body name="fore"/>
   <Body name="upper"><WrapObjectSet><objects><WrapCylinder name="bone"/></objects></WrapObjectSet></Body>
  </objects></BodySet>
  <JointSet><objects>
   <WeldJoint name="shoulder">
    <socket_parent_frame>stand</socket_parent_frame>
    <socket_child_frame>/bodyset/upper</socket_child_frame>
    <frames>
     <PhysicalOffsetFrame name="stand"><socket_parent>/ground</socket_parent>
      <translation>0 1 0</translation><orientation>0 0 0</orientation></PhysicalOffsetFrame>
    </frames>
   </WeldJoint>
   <CustomJoint name="elbow">
    <socket_parent_frame>end</socket_parent_frame>
    <socket_child_frame>/bodyset/fore</socket_child_frame>
    <coordinates><Coordinate name="flexion"><default_value>0</default_value></Coordinate></coordinates>
    <frames>
     <PhysicalOffsetFrame name="end"><socket_parent>/bodyset/upper</socket_parent>
      <translation>0 -0.5 0</translation><orientation>0 0 0</orientation></PhysicalOffsetFrame>
    </frames>
    <SpatialTransform>
     <TransformAxis name="rotation1"><coordinates>flexion</coordinates><axis>0 0 1</axis>
      <LinearFunction name="function"><coefficients>1 0</coefficients></LinearFunction></TransformAxis>
     <TransformAxis name="rotation2"><coordinates/><axis>0 1 0</axis>
      <Constant name="function"><value>0</value></Constant></TransformAxis>
     <TransformAxis name="rotation3"><coordinates/><axis>1 0 0</axis>
      <Constant name="function"><value>0</value></Constant></TransformAxis>
     <TransformAxis name="translation1"><coordinates>flexion</coordinates><axis>1 0 0</axis>
      <MultiplierFunction name="function"><function><SimmSpline><x>0 1</x><y>0 0.02</y></SimmSpline></function>
       <scale>0.5</scale></MultiplierFunction></TransformAxis>
     <TransformAxis name="translation2"><coordinates/><axis>0 1 0</axis>
      <Constant name="function"><value>0</value></Constant></TransformAxis>
     <TransformAxis name="translation3"><coordinates/><axis>0 0 1</axis>
      <Constant name="function"><value>0</value></Constant></TransformAxis>
    </SpatialTransform>
   </CustomJoint>
  </objects></JointSet>
  <ForceSet><objects>
   <Thelen2003Muscle name="biceps">
    <GeometryPath>
     <PathPointSet><objects>
      <PathPoint name="a"><socket_parent_frame>/bodyset/upper</socket_parent_frame>
       <location>0.04 0 0</location></PathPoint>
      <ConditionalPathPoint name="b"><socket_parent_frame>/bodyset/upper</socket_parent_frame>
       <location>0.07 -0.4 0</location><socket_coordinate>/jointset/elbow/flexion</socket_coordinate>
       <range>0.5 3</range></ConditionalPathPoint>
      <MovingPathPoint name="c"><socket_parent_frame>/bodyset/fore</socket_parent_frame>
       <socket_x_coordinate>/jointset/elbow/flexion</socket_x_coordinate>
       <socket_y_coordinate>/jointset/elbow/flexion</socket_y_coordinate>
       <socket_z_coordinate>/jointset/elbow/flexion</socket_z_coordinate>
       <x_location><Constant><value>0.04</value></Constant></x_location>
       <y_location><LinearFunction><coefficients>0.1 -0.1</coefficients></LinearFunction></y_location>
       <z_location><Constant><value>0</value></Constant></z_location></MovingPathPoint>
     </objects></PathPointSet>
     <PathWrapSet><objects><PathWrap name="w"><wrap_object>bone</wrap_object></PathWrap></objects></PathWrapSet>
    </GeometryPath>
    <max_isometric_force>600</max_isometric_force>
   </Thelen2003Muscle>
  </objects></ForceSet>
 </Model>
</OpenSimDocument>)";
}

// Two bodies, z up: a slide and a hinge; angles in degrees, so that the default is tried; a default class; a tendon
// around a cylinder of radius 0.1 m and one with nothing in its way.
inline std::string small_mujoco() {
  return R"(<mujoco model="limb">
 <default>
  <default class="bent"><joint axis="0 1 0"/><geom type="cylinder"/><general gaintype="muscle"/></default>
 </default>
 <worldbody>
  <body name="upper" pos="0 0 1" childclass="bent">
   <joint name="rise" type="slide" axis="0 0 2"/>
   <geom name="roll" size="0.1 1" pos="0 0 -0.5" euler="90 0 0"/>
   <site name="a" pos="0.1 0 0"/>
   <site name="d" pos="0.1 0 -0.1"/>
   <site name="side" pos="0.3 0 -0.5"/>
   <body name="fore" pos="0 0 -0.5">
    <joint name="hinge" pos="0 0 0"/>
    <site name="b" pos="0.1 0 -0.5"/>
   </body>
  </body>
 </worldbody>
 <tendon>
  <spatial name="wrapped"><site site="a"/><geom geom="roll" sidesite="side"/><site site="b"/></spatial>
  <spatial name="plain"><site site="d"/><site site="b"/></spatial>
  <spatial name="ligament"><site site="a"/><site site="d"/></spatial>
 </tendon>
 <actuator>
  <muscle name="extensor" tendon="wrapped" force="120"/>
  <general name="flexor" class="bent" tendon="plain" gainprm="0 1 60 1"/>
 </actuator>
</mujoco>)";
}

}  // namespace bodyopt::testing
